#include "fuzz.h"

FUZZ_FORMAT("vtk")
