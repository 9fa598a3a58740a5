/* bin.c: stage bin. */
#include "cpu/cpu.h"

mns_result mns_cpu_bin(struct backend *cpu, const struct frame *frame)
{
    (void)cpu;
    (void)frame;
    return MNS_OK;
}

void mns_tiles_destroy(struct backend *cpu) { (void)cpu; }
