/* blur.c: stage blur. */
#include "cpu/cpu.h"

mns_result mns_cpu_blur(struct backend *cpu, const struct frame *frame)
{
    (void)cpu;
    (void)frame;
    return MNS_OK;
}

void mns_blur_destroy(struct backend *cpu) { (void)cpu; }
