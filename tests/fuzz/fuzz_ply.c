#include "fuzz.h"

FUZZ_FORMAT("ply")
