/* splat.c: stage splat. */
#include "cpu/cpu.h"

mns_result mns_cpu_splat(struct backend *cpu, const struct frame *frame)
{
    (void)cpu;
    (void)frame;
    return MNS_OK;
}
