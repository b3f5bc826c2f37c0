#include <cstdio>  // SUNDIALS 6.4 omits it: arkode_butcher.h uses FILE.

#include "integrate/sundials/ark_methods.h"

#include <arkode/arkode_butcher_dirk.h>
#include <arkode/arkode_butcher_erk.h>

#include "palpate/core/registry.h"

namespace palpate::integrate {
namespace {

using dynamics::Stability;
using dynamics::StepControl;
using dynamics::StepperTraits;

// Runge-Kutta methods as tables (A, b, c), with an embedded one for the error.
//
//   z_i = y_n + h sum_j a_ij f(t_n + c_j h, z_j),      y_{n+1} = y_n + h sum_j b_j f(t_n + c_j h, z_j)
//
// On y' = lambda y a step multiplies by R(z), z = h lambda, R(z) = 1 + z b^T (I - z A)^-1 1. A-stable: |R(i
// y)| <= 1 for all y and the poles are right of it; L-stable: R(-inf) = 0 as well.
// tests/integrate/ark_methods_test.cpp computes both from the tables of the installed version, and checks
// that none of its tables is missing here.
//
// Explicit methods on undamped motion, z = i w h, y = w h: |R|^2 is
//   1 + y^4/4                       Heun
//   1 - y^4/12 + y^6/36             order 3
//   1 - y^6/72 + y^8/576            order 4
//   1 + y^6/3600 + ...              Cash and Karp, whose R ends in z^6/800.
// Orders 3 and 4 are stable up to w_max h = sqrt(3) and sqrt(8); with the other two every mode grows, the
// highest first, until the error control reduces the step.
//
// Order on a stiff mode (Prothero and Robinson 1974). A mode with |h lambda| >> 1 follows a smooth
// equilibrium g(t). Inserting g into the stages yields, with stage order q, the defects d_i = O(h^(q+1)
// g^(q+1)), and the error of a step is d_0 - z b^T (I - z A)^-1 d -> d_0 - b^T A^-1 d for z -> -inf.
// - Stiffly accurate (b is the last row of A, or b A^-1 c^j = 1 for all j > 0): the limit is zero and the
//   remainder is O(h^q / lambda): order q, with a small constant; but O(h^q) without it in the velocity of a
//   stiff spring, which is the derivative of its length.
// - Otherwise: O(h^(q+1)), damped from step to step by R(-inf), |R(-inf)| < 1: order q + 1.
// A first explicit stage (ESDIRK) allows q = 2, otherwise a diagonal of equal entries has q = 1. Checked for
// each table in ark_methods_test.cpp.

StepperTraits implicit(int order, int stiff_order, Stability stability) {
  return {"DIRK", order, stiff_order, StepControl::kEither, stability, true, false, "force, tangent"};
}
StepperTraits explicit_(int order) {
  return {"explicit Runge-Kutta", order, 0,     StepControl::kEither,
          Stability::kExplicit,   false, false, "force"};
}
// Only the implicit side is L-stable: the explicit side bounds the step as an explicit method does, but it is
// not stiff.
StepperTraits additive(int order) {
  return {"ImEx Runge-Kutta", order, 2,     StepControl::kEither,
          Stability::kL,      true,  false, "force, tangent; non-stiff terms on the explicit side"};
}

constexpr auto kA = Stability::kA;
constexpr auto kL = Stability::kL;

/// Returns the explicit methods.
std::vector<ArkMethod> explicit_methods() {
  return {
      {"ark-erk-2", "Heun-Euler 2(1); amplifies undamped motion at every step", 1, -1,
       ARKODE_HEUN_EULER_2_1_2, explicit_(2)},
      {"ark-erk-3", "Bogacki and Shampine 1989, 3(2); stable below 1.7/w_max", 2, -1,
       ARKODE_BOGACKI_SHAMPINE_4_2_3, explicit_(3)},
      {"ark-erk-4", "Zonneveld 1963, 4(3); stable below 2.8/w_max", 3, -1, ARKODE_ZONNEVELD_5_3_4,
       explicit_(4)},
      {"ark-erk-5",
       "Cash and Karp 1990, 5(4); used to check references; amplifies undamped motion at every step", 4, -1,
       ARKODE_CASH_KARP_6_4_5, explicit_(5)},
  };
}

/// Returns the diagonally implicit methods.
std::vector<ArkMethod> implicit_methods() {
  return {
      {"ark-dirk-sdirk212", "SDIRK 2(1), two stages", 1, ARKODE_SDIRK_2_1_2, -1, implicit(2, 1, kA)},
      {"ark-dirk-billington332", "SDIRK of Billington 1983, 2(3)", 3, ARKODE_BILLINGTON_3_3_2, -1,
       implicit(2, 2, kL)},
      {"ark-dirk-trbdf2", "TR-BDF2 of Bank et al. 1985 as an ESDIRK, 2(3)", 3, ARKODE_TRBDF2_3_3_2, -1,
       implicit(2, 2, kL)},
      {"ark-dirk-kvaerno423", "ESDIRK of Kvaerno 2004, 3(2)", 2, ARKODE_KVAERNO_4_2_3, -1,
       implicit(3, 2, kL)},
      {"ark-dirk-ark324", "ESDIRK part of ARK3(2)4L[2]SA, Kennedy and Carpenter 2003, 3(2)", 2,
       ARKODE_ARK324L2SA_DIRK_4_2_3, -1, implicit(3, 2, kL)},
      {"ark-dirk-cash524", "SDIRK of Cash 1979, 4(2)", 2, ARKODE_CASH_5_2_4, -1, implicit(4, 1, kL)},
      {"ark-dirk-cash534", "SDIRK of Cash 1979, 4(3)", 3, ARKODE_CASH_5_3_4, -1, implicit(4, 1, kL)},
      {"ark-dirk-sdirk534", "SDIRK of Hairer and Wanner 1996, 4(3)", 3, ARKODE_SDIRK_5_3_4, -1,
       implicit(4, 1, kL)},
      {"ark-dirk-kvaerno534", "ESDIRK of Kvaerno 2004, 4(3); R(-inf) = 0.72 in SUNDIALS' table", 3,
       ARKODE_KVAERNO_5_3_4, -1, implicit(4, 2, kA)},
      {"ark-dirk-ark436", "ESDIRK part of ARK4(3)6L[2]SA, Kennedy and Carpenter 2003, 4(3)", 3,
       ARKODE_ARK436L2SA_DIRK_6_3_4, -1, implicit(4, 2, kL)},
      {"ark-dirk-ark437", "ESDIRK part of ARK4(3)7L[2]SA1, Kennedy and Carpenter 2019, 4(3)", 3,
       ARKODE_ARK437L2SA_DIRK_7_3_4, -1, implicit(4, 2, kL)},
      {"ark-dirk-kvaerno745", "ESDIRK of Kvaerno 2004, 5(4)", 4, ARKODE_KVAERNO_7_4_5, -1,
       implicit(5, 2, kL)},
      {"ark-dirk-ark548", "ESDIRK part of ARK5(4)8L[2]SA, Kennedy and Carpenter 2003, 5(4)", 4,
       ARKODE_ARK548L2SA_DIRK_8_4_5, -1, implicit(5, 2, kL), true},
      {"ark-dirk-ark548b", "ESDIRK part of ARK5(4)8L[2]SA2, Kennedy and Carpenter 2019, 5(4)", 4,
       ARKODE_ARK548L2SAb_DIRK_8_4_5, -1, implicit(5, 2, kL)},

      {"ark-dirk-esdirk324", "ESDIRK3(2)4L[2]SA, Kennedy and Carpenter 2016", 2, ARKODE_ESDIRK324L2SA_4_2_3,
       -1, implicit(3, 2, kL)},
      {"ark-dirk-esdirk325", "ESDIRK3(2)5L[2]SA, Kennedy and Carpenter 2016", 2, ARKODE_ESDIRK325L2SA_5_2_3,
       -1, implicit(3, 2, kL)},
      {"ark-dirk-esdirk32i5", "ESDIRK3(2I)5L[2]SA, Kennedy and Carpenter 2016", 2,
       ARKODE_ESDIRK32I5L2SA_5_2_3, -1, implicit(3, 2, kL)},
      {"ark-dirk-esdirk436", "ESDIRK4(3)6L[2]SA, Kennedy and Carpenter 2016", 3, ARKODE_ESDIRK436L2SA_6_3_4,
       -1, implicit(4, 2, kL)},
      {"ark-dirk-esdirk43i6", "ESDIRK4(3I)6L[2]SA, Kennedy and Carpenter 2016", 3,
       ARKODE_ESDIRK43I6L2SA_6_3_4, -1, implicit(4, 2, kL)},
      {"ark-dirk-qesdirk436", "QESDIRK4(3)6L[2]SA, Kennedy and Carpenter 2016", 3,
       ARKODE_QESDIRK436L2SA_6_3_4, -1, implicit(4, 2, kL)},
      {"ark-dirk-esdirk437", "ESDIRK4(3)7L[2]SA, Kennedy and Carpenter 2019", 3, ARKODE_ESDIRK437L2SA_7_3_4,
       -1, implicit(4, 2, kL), true},
      {"ark-dirk-esdirk547", "ESDIRK5(4)7L[2]SA, Kennedy and Carpenter 2016", 4, ARKODE_ESDIRK547L2SA_7_4_5,
       -1, implicit(5, 2, kL)},
      {"ark-dirk-esdirk547b", "ESDIRK5(4)7L[2]SA2, Kennedy and Carpenter 2019", 4,
       ARKODE_ESDIRK547L2SA2_7_4_5, -1, implicit(5, 2, kL)},
  };
}

/// Returns the pairs of an implicit and an explicit method.
std::vector<ArkMethod> additive_methods() {
  return {
      {"ark-imex-3",
       "ARK3(2)4L[2]SA, Kennedy and Carpenter 2003: elastic forces implicit, the rest by explicit_side", 2,
       ARKODE_ARK324L2SA_DIRK_4_2_3, ARKODE_ARK324L2SA_ERK_4_2_3, additive(3)},
      {"ark-imex-4", "ARK4(3)6L[2]SA, Kennedy and Carpenter 2003", 3, ARKODE_ARK436L2SA_DIRK_6_3_4,
       ARKODE_ARK436L2SA_ERK_6_3_4, additive(4)},
      {"ark-imex-4b", "ARK4(3)7L[2]SA1, Kennedy and Carpenter 2019", 3, ARKODE_ARK437L2SA_DIRK_7_3_4,
       ARKODE_ARK437L2SA_ERK_7_3_4, additive(4)},
      {"ark-imex-5", "ARK5(4)8L[2]SA, Kennedy and Carpenter 2003", 4, ARKODE_ARK548L2SA_DIRK_8_4_5,
       ARKODE_ARK548L2SA_ERK_8_4_5, additive(5), true},
      {"ark-imex-5b",
       "ARK5(4)8L[2]SA2, Kennedy and Carpenter 2019; its error estimate misses kinks: with contact, use "
       "events = \"root-finding\"",
       4, ARKODE_ARK548L2SAb_DIRK_8_4_5, ARKODE_ARK548L2SAb_ERK_8_4_5, additive(5)},
  };
}

}  // namespace

const std::vector<ArkMethod>& ark_methods() {
  static const std::vector<ArkMethod> methods = [] {
    std::vector<ArkMethod> out = explicit_methods();
    for (const auto& others : {implicit_methods(), additive_methods()})
      out.insert(out.end(), others.begin(), others.end());
    return out;
  }();
  return methods;
}

const ArkMethod& ark_method(const std::string& name) { return find(ark_methods(), name, "method of ARKODE"); }

}  // namespace palpate::integrate
