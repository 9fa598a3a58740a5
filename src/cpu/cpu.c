/* cpu.c: the CPU backend: what it holds, and its row of functions. */
#include "cpu/cpu.h"

#include "cpu/smooth/filter.h"
#include "cpu/sky.h"

static mns_result create(struct backend **out, const struct backend_host *host, const struct mns_renderer_params *params)
{
    enum mns_isa isa = params->isa == MNS_ISA_AUTO ? mns_isa_best() : params->isa;
    const struct kernels *kernels = mns_kernels_get(isa);
    if (!kernels) {
        const char *name = mns_isa_name(isa);
        return mns_fail(host->message, MNS_ERR_UNSUPPORTED, "instruction set %s is not in this build or not on this processor",
                        name ? name : "unknown");
    }
    struct backend *cpu = mns_memory_get(host->memory, 1, sizeof(*cpu));
    if (!cpu) {
        return mns_fail(host->message, MNS_ERR_OUT_OF_MEMORY, "out of memory");
    }
    *cpu = (struct backend){.host = *host, .kernels = kernels, .isa = isa};
    *out = cpu;
    return MNS_OK;
}

static void free_thickness(struct thickness_image *image, struct memory *memory)
{
    mns_plane_free(&image->thickness, memory);
    for (int c = 0; c < 3; c++) {
        mns_plane_free(&image->color[c], memory);
    }
}

static void destroy(struct backend *cpu)
{
    struct memory *memory = cpu->host.memory;
    mns_bin_destroy(cpu);
    mns_scene_destroy(cpu);
    mns_noise_destroy(cpu);
    mns_blur_destroy(cpu);
    mns_foam_destroy(cpu);
    mns_spray_destroy(cpu);
    free_thickness(&cpu->raw, memory);
    free_thickness(&cpu->blurred, memory);
    mns_depth_plane_free(&cpu->depth_raw, memory);
    mns_depth_plane_free(&cpu->depth[0], memory);
    mns_depth_plane_free(&cpu->depth[1], memory);
    for (int i = 0; i < 3; i++) {
        mns_plane_free(&cpu->depth_normal[i], memory);
    }
    mns_resample_destroy(cpu);
    mns_memory_put(memory, cpu->block_values, cpu->block_values_capacity, sizeof(*cpu->block_values));
    mns_memory_put(memory, cpu->line_scratch, cpu->line_scratch_capacity, sizeof(*cpu->line_scratch));
    mns_memory_put(memory, cpu->picture, cpu->picture_capacity, sizeof(*cpu->picture));
    for (int kind = 0; kind < STORE_KINDS; kind++) {
        mns_particle_store_free(&cpu->stores[kind], memory);
    }
    mns_memory_put(memory, cpu, 1, sizeof(*cpu));
}

static mns_result prepare(struct backend *cpu, const struct mns_particles *particles, struct mns_measure *measure,
                          struct particle_facts *facts)
{
    cpu->generation++;
    mns_result result = mns_particle_stores_fill(cpu->stores, cpu->host.memory, &cpu->host.parallel, cpu->host.threads, particles, cpu->host.passes,
                                                 measure, cpu->host.message);
    *facts = cpu->stores[STORE_WATER].facts;
    return result;
}

static mns_result prepare_diffuse(struct backend *cpu, const struct mns_particles *diffuse, size_t *dropped)
{
    return mns_particle_stores_diffuse(cpu->stores, cpu->host.memory, &cpu->host.parallel, cpu->host.threads, diffuse, dropped,
                                       cpu->host.message);
}

static void stats(const struct backend *cpu, struct backend_stats *out)
{
    *out = cpu->stats;
    out->isa = mns_isa_name(cpu->isa);
}

const struct backend_functions mns_backend_cpu = {
    .name = "cpu",
    .create = create,
    .destroy = destroy,
    .prepare = prepare,
    .prepare_diffuse = prepare_diffuse,
    .stages = {[STAGE_SCENE] = mns_cpu_scene,
               [STAGE_BIN] = mns_cpu_bin,
               [STAGE_SPLAT] = mns_cpu_splat,
               [STAGE_SMOOTH] = mns_cpu_smooth,
               [STAGE_NOISE] = mns_cpu_noise,
               [STAGE_BLUR] = mns_cpu_blur,
               [STAGE_FOAM] = mns_cpu_foam,
               [STAGE_SPRAY] = mns_cpu_spray,
               [STAGE_SHADE] = mns_cpu_shade,
               [STAGE_PASSES] = mns_cpu_passes},
    .light = mns_cpu_light,
    .stats = stats,
};
