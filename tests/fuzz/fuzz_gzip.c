/* Any format, told from the content, as it is told for users; its corpus is of gzip files. */
#include "fuzz.h"

FUZZ_FORMAT(NULL)
