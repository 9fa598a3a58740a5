#include "fuzz.h"

FUZZ_FORMAT("bgeo")
