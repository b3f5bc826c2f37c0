#pragma once
#include <string_view>

#include "palpate/core/types.h"

namespace palpate::integrate {

/// Returns the largest modulus of an eigenvalue of one step of a multi-rate method on  y' = (S + F) y,  with
/// the slow side S implicit and the fast side F integrated exactly between the slow stages. Above 1, small
/// perturbations grow.
/// Derivation: src/integrate/sundials/multirate.cpp. No multi-rate infinitesimal method is known to be stable
/// whenever both sides are. Each side alone is stable; where both are stiff and coupled (step |S|, step |F|
/// above 1) stability has to be checked.
/// @param method  "ark-mri-2", ...
/// @param slow, fast  square, of the same size [1/s]
/// @param step_s  the slow step [s]
/// @throws Error for a method that is not multi-rate, or matrices that do not fit
double multirate_amplification(std::string_view method, const MatX& slow, const MatX& fast, double step_s);

}  // namespace palpate::integrate
