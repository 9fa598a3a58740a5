/* where.c: expressions that pick particles, "type == 0 && density > 200", or give each a number, "velocity.y".
 *
 *   or      = and { "||" and }                 compare = sum [ ("==" | "!=" | "<" | "<=" | ">" | ">=") sum ]
 *   and     = compare { "&&" compare }         sum     = product { ("+" | "-") product }
 *   unary   = { "!" | "-" | "+" } primary      product = unary { ("*" | "/") unary }
 *   primary = number | name [ "." component ] | "(" or ")"
 *
 * A name is an attribute, or a role (velocity), or x, y, z of the position; in quotes where it is no plain word. A vector by itself stands for
 * its magnitude. The expression is compiled to a stack program, which runs in double precision over blocks of particles. */
#include "core/message.h"
#include "io/set.h"

#include <math.h>
#include <string.h>

enum { BLOCK = 512, STACK_MAX = 32, PROGRAM_MAX = 256, NEST_MAX = 100 };

enum operation {
    NUMBER,
    LOAD,
    NEGATE,
    NOT,
    ADD,
    SUBTRACT,
    MULTIPLY,
    DIVIDE,
    EQUAL,
    UNEQUAL,
    LESS,
    LESS_EQUAL,
    GREATER,
    GREATER_EQUAL,
    AND,
    OR
};

struct instruction {
    enum operation operation;
    double number;
    struct mns_attribute attribute; /* LOAD */
    int component;                  /* LOAD: -1 for the magnitude */
};

struct compiler {
    struct read_context *context;
    const char *what; /* "where", for messages */
    const char *text, *at;
    struct instruction *program; /* [PROGRAM_MAX] */
    int length, stack, stack_most, nesting;
    bool failed;
};

static void fail(struct compiler *compiler, const char *what)
{
    if (!compiler->failed) {
        mns_read_fail(compiler->context, MNS_ERR_INVALID_ARGUMENT, "%s '%.300s': column %d: %s", compiler->what, compiler->text,
                      (int)(compiler->at - compiler->text) + 1, what);
    }
    compiler->failed = true;
}

/* operands: how many the instruction takes from the stack; it gives one back. */
static void emit(struct compiler *compiler, struct instruction instruction, int operands)
{
    if (compiler->failed) {
        return;
    }
    compiler->stack += 1 - operands;
    if (compiler->length == PROGRAM_MAX || compiler->stack > STACK_MAX) {
        fail(compiler, "the expression is too long");
        return;
    }
    if (compiler->stack > compiler->stack_most) {
        compiler->stack_most = compiler->stack;
    }
    compiler->program[compiler->length++] = instruction;
}

static void emit_operation(struct compiler *compiler, enum operation operation, int operands)
{
    emit(compiler, (struct instruction){.operation = operation}, operands);
}

static void skip_space(struct compiler *compiler)
{
    while (*compiler->at == ' ' || *compiler->at == '\t') {
        compiler->at++;
    }
}

static bool accept(struct compiler *compiler, const char *token)
{
    skip_space(compiler);
    size_t length = strlen(token);
    if (strncmp(compiler->at, token, length) != 0) {
        return false;
    }
    compiler->at += length;
    return true;
}

static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (unsigned char)c >= 0x80; }

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

static const struct attribute *find_by_role(const mns_particle_set *set, const char *name, size_t length)
{
    for (size_t i = 0; i < set->listed_count; i++) {
        const char *role = mns_role_name(set->attributes[i].is.role);
        if (set->attributes[i].is.role != MNS_ROLE_NONE && strlen(role) == length && memcmp(role, name, length) == 0) {
            return &set->attributes[i];
        }
    }
    return NULL;
}

static void load(struct compiler *compiler, const char *name, size_t length)
{
    const mns_particle_set *set = compiler->context->set;
    const struct attribute *attribute = mns_set_find(set, name, length);
    int component = -1;
    if (!attribute) {
        attribute = find_by_role(set, name, length);
    }
    if (!attribute && length == 1 && *name >= 'x' && *name <= 'z') {
        attribute = find_by_role(set, "position", 8);
        component = *name - 'x';
    }
    if (!attribute && set->count > 0) {
        char names[400], what[600];
        mns_set_list(set, names, sizeof(names));
        struct mns_message line;
        mns_fail(&line, MNS_OK, "no attribute '%.*s'; there is %s", length < 100 ? (int)length : 100, name, names);
        memcpy(what, line.text, sizeof(what) - 1);
        what[sizeof(what) - 1] = '\0';
        compiler->at = name;
        fail(compiler, what);
        return;
    }
    struct instruction instruction = {.operation = attribute ? LOAD : NUMBER, .component = component};
    if (attribute) {
        instruction.attribute = attribute->is;
    }
    if (*compiler->at == '.') {
        const char *c = ++compiler->at;
        int wanted = *c >= 'x' && *c <= 'z' ? *c - 'x' : *c == 'w' ? 3 : is_digit(*c) ? *c - '0' : -1;
        bool known = wanted >= 0 && !is_letter(c[1]) && !is_digit(c[1]);
        if (!known || component >= 0 || (attribute && wanted >= instruction.attribute.components)) {
            fail(compiler, "no such component: a vector's are .x .y .z or .0 .1 .2 ...");
            return;
        }
        instruction.component = wanted;
        compiler->at++;
    }
    emit(compiler, instruction, 0);
}

static void parse_or(struct compiler *compiler);

static void parse_primary(struct compiler *compiler)
{
    skip_space(compiler);
    const char *start = compiler->at;
    if (accept(compiler, "(")) {
        parse_or(compiler);
        if (!accept(compiler, ")")) {
            fail(compiler, "')' is missing");
        }
    } else if (*start == '\'' || *start == '"') {
        const char *end = strchr(start + 1, *start);
        compiler->at = end ? end + 1 : start;
        if (!end) {
            fail(compiler, "the quote is not closed");
        } else {
            load(compiler, start + 1, (size_t)(end - start - 1));
        }
    } else if (is_digit(*start) || *start == '.') {
        struct instruction number = {.operation = NUMBER};
        const char *end = mns_parse_double(start, start + strlen(start), &number.number);
        if (!end) {
            fail(compiler, "this is no number");
            return;
        }
        compiler->at = end;
        emit(compiler, number, 0);
    } else if (is_letter(*start)) {
        while (is_letter(*compiler->at) || is_digit(*compiler->at)) {
            compiler->at++;
        }
        load(compiler, start, (size_t)(compiler->at - start));
    } else {
        fail(compiler, *start ? "a number, a name or '(' should stand here" : "the expression ends too early");
    }
}

static void parse_unary(struct compiler *compiler)
{
    if (++compiler->nesting > NEST_MAX) {
        fail(compiler, "the expression is nested too deeply");
    }
    skip_space(compiler);
    if (compiler->failed) {
        /* nothing more to say */
    } else if (*compiler->at == '!' && compiler->at[1] != '=') {
        compiler->at++;
        parse_unary(compiler);
        emit_operation(compiler, NOT, 1);
    } else if (accept(compiler, "-")) {
        parse_unary(compiler);
        emit_operation(compiler, NEGATE, 1);
    } else if (accept(compiler, "+")) {
        parse_unary(compiler);
    } else {
        parse_primary(compiler);
    }
    compiler->nesting--;
}

static void parse_product(struct compiler *compiler)
{
    parse_unary(compiler);
    while (!compiler->failed) {
        enum operation operation = accept(compiler, "*") ? MULTIPLY : accept(compiler, "/") ? DIVIDE : NUMBER;
        if (operation == NUMBER) {
            break;
        }
        parse_unary(compiler);
        emit_operation(compiler, operation, 2);
    }
}

static void parse_sum(struct compiler *compiler)
{
    parse_product(compiler);
    while (!compiler->failed) {
        enum operation operation = accept(compiler, "+") ? ADD : accept(compiler, "-") ? SUBTRACT : NUMBER;
        if (operation == NUMBER) {
            break;
        }
        parse_product(compiler);
        emit_operation(compiler, operation, 2);
    }
}

static enum operation accept_comparison(struct compiler *compiler)
{
    static const struct {
        const char *token;
        enum operation operation;
    } comparisons[] = {{"==", EQUAL}, {"!=", UNEQUAL}, {"<=", LESS_EQUAL}, {">=", GREATER_EQUAL}, {"<", LESS}, {">", GREATER}};
    for (size_t i = 0; i < sizeof(comparisons) / sizeof(comparisons[0]); i++) {
        if (accept(compiler, comparisons[i].token)) {
            return comparisons[i].operation;
        }
    }
    return NUMBER;
}

static void parse_compare(struct compiler *compiler)
{
    parse_sum(compiler);
    enum operation operation = accept_comparison(compiler);
    if (operation == NUMBER) {
        return;
    }
    parse_sum(compiler);
    emit_operation(compiler, operation, 2);
    if (accept_comparison(compiler) != NUMBER) {
        fail(compiler, "comparisons do not chain: write a < b && b < c");
    }
}

static void parse_and(struct compiler *compiler)
{
    parse_compare(compiler);
    while (!compiler->failed && accept(compiler, "&&")) {
        parse_compare(compiler);
        emit_operation(compiler, AND, 2);
    }
}

static void parse_or(struct compiler *compiler)
{
    parse_and(compiler);
    while (!compiler->failed && accept(compiler, "||")) {
        parse_and(compiler);
        emit_operation(compiler, OR, 2);
    }
}

static void compile(struct compiler *compiler)
{
    parse_or(compiler);
    skip_space(compiler);
    if (*compiler->at == '=') {
        fail(compiler, "'=' is no comparison: write ==");
    } else if (*compiler->at != '\0') {
        fail(compiler, "an operator should stand here: == != < <= > >= && || + - * /");
    }
}

/* ---- running ---- */

#define LOAD_AS(type)                                                                                                                      \
    do {                                                                                                                                   \
        const type *in = (const type *)attribute->data + start * components;                                                               \
        if (component >= 0) {                                                                                                              \
            for (size_t i = 0; i < count; i++)                                                                                             \
                out[i] = (double)in[i * components + (size_t)component];                                                                   \
        } else {                                                                                                                           \
            for (size_t i = 0; i < count; i++) {                                                                                           \
                double sum = 0.0;                                                                                                          \
                for (size_t c = 0; c < components; c++)                                                                                    \
                    sum += (double)in[i * components + c] * (double)in[i * components + c];                                                \
                out[i] = sqrt(sum);                                                                                                        \
            }                                                                                                                              \
        }                                                                                                                                  \
    } while (0)

static void run_load(const struct instruction *instruction, size_t start, size_t count, double *out)
{
    const struct mns_attribute *attribute = &instruction->attribute;
    size_t components = (size_t)attribute->components;
    int component = components == 1 ? 0 : instruction->component;
    switch (attribute->type) {
    case MNS_F32: LOAD_AS(float); break;
    case MNS_F64: LOAD_AS(double); break;
    case MNS_I8: LOAD_AS(int8_t); break;
    case MNS_U8: LOAD_AS(uint8_t); break;
    case MNS_I16: LOAD_AS(int16_t); break;
    case MNS_U16: LOAD_AS(uint16_t); break;
    case MNS_I32: LOAD_AS(int32_t); break;
    case MNS_U32: LOAD_AS(uint32_t); break;
    case MNS_I64: LOAD_AS(int64_t); break;
    case MNS_U64: LOAD_AS(uint64_t); break;
    }
}

#define EACH(expression)                                                                                                                   \
    do {                                                                                                                                   \
        for (size_t i = 0; i < count; i++)                                                                                                 \
            a[i] = (expression) ? 1.0 : 0.0;                                                                                               \
    } while (0)
#define EACH_VALUE(expression)                                                                                                             \
    do {                                                                                                                                   \
        for (size_t i = 0; i < count; i++)                                                                                                 \
            a[i] = (expression);                                                                                                           \
    } while (0)

/* a: the lower operand, where the result goes; b: the upper one, above it on the stack. */
static void run_operation(enum operation operation, double *restrict a, const double *restrict b, size_t count)
{
    switch (operation) {
    case NEGATE: EACH_VALUE(-a[i]); break;
    case NOT: EACH(a[i] == 0.0); break;
    case ADD: EACH_VALUE(a[i] + b[i]); break;
    case SUBTRACT: EACH_VALUE(a[i] - b[i]); break;
    case MULTIPLY: EACH_VALUE(a[i] * b[i]); break;
    case DIVIDE: EACH_VALUE(a[i] / b[i]); break;
    case EQUAL: EACH(a[i] == b[i]); break;
    case UNEQUAL: EACH(a[i] != b[i]); break;
    case LESS: EACH(a[i] < b[i]); break;
    case LESS_EQUAL: EACH(a[i] <= b[i]); break;
    case GREATER: EACH(a[i] > b[i]); break;
    case GREATER_EQUAL: EACH(a[i] >= b[i]); break;
    case AND: EACH(a[i] != 0.0 && b[i] != 0.0); break;
    case OR: EACH(a[i] != 0.0 || b[i] != 0.0); break;
    case NUMBER:
    case LOAD: break;
    }
}

/* The values of count particles from start on, in stack. */
static void run_block(const struct compiler *program, double *stack, size_t start, size_t count)
{
    double *top = stack; /* the next free row */
    for (int i = 0; i < program->length; i++) {
        const struct instruction *instruction = &program->program[i];
        switch (instruction->operation) {
        case NUMBER:
            for (size_t k = 0; k < count; k++) {
                top[k] = instruction->number;
            }
            top += BLOCK;
            break;
        case LOAD:
            run_load(instruction, start, count, top);
            top += BLOCK;
            break;
        case NEGATE:
        case NOT: run_operation(instruction->operation, top - BLOCK, top, count); break;
        default:
            top -= BLOCK;
            run_operation(instruction->operation, top - BLOCK, top, count);
            break;
        }
    }
}

/* keep or values, whichever is not NULL. */
static mns_result run(struct compiler *compiler, uint8_t *keep, double *values)
{
    struct read_context *context = compiler->context;
    size_t count = context->set->count, rows = (size_t)compiler->stack_most + 1; /* one above, which operations on one operand name */
    double *stack = mns_read_alloc(context, rows * BLOCK, sizeof(*stack));
    if (!stack) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    for (size_t start = 0; start < count; start += BLOCK) {
        size_t n = count - start < BLOCK ? count - start : BLOCK;
        run_block(compiler, stack, start, n);
        for (size_t k = 0; k < n && keep; k++) {
            keep[start + k] &= stack[k] < 0.0 || stack[k] > 0.0; /* NaN is not true */
        }
        if (values) {
            memcpy(values + start, stack, n * sizeof(*values));
        }
    }
    mns_read_free(context, stack, rows * BLOCK, sizeof(*stack));
    return MNS_OK;
}

static mns_result evaluate(struct read_context *context, const char *what, const char *expression, uint8_t *keep, double *values)
{
    struct compiler compiler = {.context = context, .what = what, .text = expression, .at = expression};
    compiler.program = mns_read_alloc(context, PROGRAM_MAX, sizeof(*compiler.program));
    if (!compiler.program) {
        return MNS_ERR_OUT_OF_MEMORY;
    }
    compile(&compiler);
    mns_result result = compiler.failed ? MNS_ERR_INVALID_ARGUMENT : run(&compiler, keep, values);
    mns_read_free(context, compiler.program, PROGRAM_MAX, sizeof(*compiler.program));
    return result;
}

mns_result mns_where(struct read_context *context, const char *expression, uint8_t *keep)
{
    return evaluate(context, "where", expression, keep, NULL);
}

mns_result mns_particle_set_evaluate(const mns_particle_set *set, const char *name, const char *expression, double *out,
                                     struct mns_message *message)
{
    struct mns_message unread;
    struct mns_read_params params;
    if (!set || !expression || (!out && set->count > 0)) {
        return mns_fail(message, MNS_ERR_INVALID_ARGUMENT, "mns_particle_set_evaluate: set, expression or out is NULL");
    }
    mns_read_params_init(&params);
    mns_particle_set view = *set; /* with an account of memory of its own: many threads may read the set */
    mns_memory_init(&view.memory, &set->memory.allocator);
    struct read_context context = {.path = name, .params = &params, .message = message ? message : &unread, .set = &view};
    return evaluate(&context, "value", expression, NULL, out);
}
