#pragma once
#include <string_view>

#include "palpate/core/types.h"

namespace palpate::integrate {

/// Largest modulus of an eigenvalue of one step of a multi-rate method on  y' = (S + F) y,  the slow side S
/// implicit, the fast side F integrated exactly between the slow stages: above 1, what is small grows.
/// Derivation: src/integrate/sundials/multirate.cpp. No multi-rate infinitesimal method is known to be stable
/// whenever both sides are: that holds for each alone, and where the two are stiff in each other (step |S|,
/// step |F| above 1) it has to be looked at.
/// @param method  "ark-mri-2", ...   @param slow, fast  square, of one size [1/s]   @param step_s  the slow
///   step [s]
/// @throws Error for a method that is not multi-rate, or matrices that do not fit
double multirate_amplification(std::string_view method, const MatX& slow, const MatX& fast, double step_s);

}  // namespace palpate::integrate
