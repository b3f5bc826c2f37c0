#pragma once
#include "simbody/headers.h"

// Simbody's own contact, which is measured against ours and used for nothing else.  As in headers.h, it must
// see the setting of NDEBUG that the library was built with.
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
