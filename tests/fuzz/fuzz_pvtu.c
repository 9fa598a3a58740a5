#include "fuzz.h"

FUZZ_FORMAT("pvtu")
