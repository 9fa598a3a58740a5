#include "fuzz.h"

FUZZ_FORMAT("csv")
