#include "fuzz.h"

FUZZ_FORMAT("vtu")
