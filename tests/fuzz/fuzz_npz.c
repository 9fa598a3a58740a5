#include "fuzz.h"

FUZZ_FORMAT("npz")
