/* scene.c: stage scene. */
#include "cpu/cpu.h"

mns_result mns_cpu_scene(struct backend *cpu, const struct frame *frame)
{
    (void)cpu;
    (void)frame;
    return MNS_OK;
}

void mns_scene_destroy(struct backend *cpu) { (void)cpu; }
