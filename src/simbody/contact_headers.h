#pragma once
#include "simbody/headers.h"

// Headers of Simbody's contact model, which is used only for comparison with palpate's. As in headers.h, they
// must see the setting of NDEBUG that the library was built with.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#ifdef PALPATE_SIMBODY_NDEBUG
#define NDEBUG
#endif
#include <cassert>

#include <simbody/internal/ElasticFoundationForce.h>
#include <simbody/internal/GeneralContactSubsystem.h>
#include <simbody/internal/MobilizedBody_Translation.h>

#pragma pop_macro("NDEBUG")
#include <cassert>
