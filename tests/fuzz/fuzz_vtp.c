#include "fuzz.h"

FUZZ_FORMAT("vtp")
