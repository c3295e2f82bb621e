/// NPDR_SCALAR: the scalar that the templates of this folder are instantiated for. Tests, which
/// compare gradients with differences, compile them once more, for double.
#pragma once

#ifndef NPDR_SCALAR
#define NPDR_SCALAR float
#endif
