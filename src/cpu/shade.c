/* shade.c: stage shade. */
#include "cpu/cpu.h"

mns_result mns_cpu_shade(struct backend *cpu, const struct frame *frame)
{
    (void)cpu;
    (void)frame;
    return MNS_OK;
}

void mns_shade_destroy(struct backend *cpu) { (void)cpu; }
