/* Particles matched from set to set by their ids: dense, sparse, shuffled, repeated, gone and come back. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "particles/ids.h"

#include <stdlib.h>

static void run_backwards(void *user, void (*job)(void *context, int index), void *context, int count)
{
    (void)user;
    for (int i = count - 1; i >= 0; i--) {
        job(context, i);
    }
}

static const struct mns_parallel parallel = {.run = run_backwards};

static struct id_news match(struct ids *ids, struct memory *memory, const int64_t *id, size_t count, uint32_t *from)
{
    const struct mns_attr attr = {.data = id, .type = MNS_I64};
    struct id_news news;
    assert_true(mns_ids_match(ids, memory, &parallel, &attr, count, from, &news));
    return news;
}

static void test_a_few_by_hand(void **state)
{
    (void)state;
    struct memory memory;
    mns_memory_init(&memory, NULL);
    struct ids ids = {0};
    uint32_t from[5];
    const int64_t first[] = {10, -3, 7}, second[] = {7, 11, 10, 7}, third[] = {-3, 11, 7};
    struct id_news news = match(&ids, &memory, first, 3, from);
    assert_true(news.appeared == 3 && news.vanished == 0 && news.repeated == 0 && news.returned == 0);
    assert_true(from[0] == ID_NONE && from[1] == ID_NONE && from[2] == ID_NONE);

    news = match(&ids, &memory, second, 4, from);
    assert_true(from[0] == 2 && from[1] == ID_NONE && from[2] == 0 && from[3] == 2);
    assert_true(news.appeared == 1 && news.vanished == 1 && news.repeated == 1 && news.first_repeated == 7);

    news = match(&ids, &memory, third, 3, from);
    assert_true(from[0] == ID_NONE && from[1] == 1 && from[2] == 0); /* the first of the two 7 */
    assert_true(news.appeared == 1 && news.returned == 1 && news.first_returned == -3 && news.vanished == 1 && news.repeated == 0);

    mns_ids_forget(&ids);
    news = match(&ids, &memory, third, 3, from);
    assert_true(news.appeared == 3 && news.returned == 0 && news.vanished == 0 && from[1] == ID_NONE);
    mns_ids_free(&ids, &memory);
    assert_int_equal(memory.bytes, 0);
}

/* Ids a stride apart, in another order in every set, a tenth of them new each time: as the formula has it, and in a bounded table. */
static void test_many_sets(void **state)
{
    (void)state;
    enum { COUNT = 20000, SETS = 40, FRESH = COUNT / 10 };
    static const int64_t strides[] = {1, 1 << 20, 1000003, INT64_C(1) << 40};
    int64_t *id = malloc(COUNT * sizeof(*id));
    uint32_t *from = malloc(COUNT * sizeof(*from));
    for (int stride = 0; stride < 4; stride++) {
        struct memory memory;
        mns_memory_init(&memory, NULL);
        struct ids ids = {0};
        for (int64_t set = 0; set < SETS; set++) {
            for (int64_t i = 0; i < COUNT;
                 i++) { /* place p holds member (p * 7 + set) mod COUNT of ids [set * FRESH, set * FRESH + COUNT) */
                id[i] = (set * FRESH + (i * 7 + set) % COUNT) * strides[stride];
            }
            struct id_news news = match(&ids, &memory, id, COUNT, from);
            assert_int_equal(news.appeared, set ? FRESH : COUNT);
            assert_int_equal(news.vanished, set ? FRESH : 0);
            for (int64_t i = 0; set > 0 && i < COUNT; i++) {
                int64_t member =
                    id[i] / strides[stride] - (set - 1) * FRESH; /* of the set before: at place p with 7 p + set - 1 = member */
                assert_true(member >= COUNT ? from[i] == ID_NONE : (from[i] * INT64_C(7) + set - 1) % COUNT == member);
            }
        }
        assert_true(ids.capacity <= 8 * COUNT);
        mns_ids_free(&ids, &memory);
    }
    free(id);
    free(from);
}

static void test_ids_of_other_types(void **state)
{
    (void)state;
    struct memory memory;
    mns_memory_init(&memory, NULL);
    struct ids ids = {0};
    uint32_t from[2];
    struct id_news news;
    const float a[] = {3, 5}, b[] = {5, 1e30f};
    struct mns_attr attr = {.data = a, .type = MNS_F32};
    assert_true(mns_ids_match(&ids, &memory, &parallel, &attr, 2, from, &news));
    attr.data = b;
    assert_true(mns_ids_match(&ids, &memory, &parallel, &attr, 2, from, &news));
    assert_true(from[0] == 1 && from[1] == ID_NONE);
    const struct {
        uint16_t id, other;
    } c[] = {{9, 1}, {5, 2}};
    attr = (struct mns_attr){.data = c, .type = MNS_U16, .stride = sizeof(c[0])};
    assert_true(mns_ids_match(&ids, &memory, &parallel, &attr, 2, from, &news));
    assert_true(from[0] == ID_NONE && from[1] == 0);
    mns_ids_free(&ids, &memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_few_by_hand),
        cmocka_unit_test(test_many_sets),
        cmocka_unit_test(test_ids_of_other_types),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
