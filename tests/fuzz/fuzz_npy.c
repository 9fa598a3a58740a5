#include "fuzz.h"

FUZZ_FORMAT("npy")
