/* smooth.c: stage smooth. */
#include "cpu/cpu.h"

mns_result mns_cpu_smooth(struct backend *cpu, const struct frame *frame)
{
    (void)cpu;
    (void)frame;
    return MNS_OK;
}
