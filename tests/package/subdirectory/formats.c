/* formats.c: what meniscus::io reads and writes, from a folder beside the one that found its libraries. */
#include <meniscus/io.h>

#include <stdio.h>

int main(void)
{
    size_t count = 0;
    while (mns_read_format(count)) {
        printf("reads %s\n", mns_read_format(count));
        count++;
    }
    for (size_t i = 0; mns_image_write_format(i); i++) {
        printf("writes %s\n", mns_image_write_format(i));
    }
    return count ? 0 : 1;
}
