#include "fuzz.h"

FUZZ_FORMAT("pvd")
