#include <limits>

#include "palpate/study/fem_bench.h"

namespace palpate::study {

const std::vector<BeamSize>& beam_sizes() {
  static const std::vector<BeamSize> sizes = {{"XS", 16, 4}, {"S", 36, 9}, {"M", 56, 13}, {"L", 80, 19}, {"XL", 117, 28}};
  return sizes;
}

// Measured once, with the settings that each program's own users take, on the machine whose bandwidth is below; not measured again here.
const std::vector<PeerFigure>& peer_figures() {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  static const std::vector<PeerFigure> figures = {
      {"SOFA, FastTetrahedralCorotational, CG", "S", 23.8, 11.0, "1e-6"},
      {"SOFA, FastTetrahedralCorotational, CG", "S", 15.5, none, "1e-3"},
      {"SOFA, FastTetrahedralCorotational, CG", "M", 99, 43.9, "1e-6"},
      {"SOFA, FastTetrahedralCorotational, CG", "L", 387, 138, "1e-6"},
      {"Vega, warped, Jacobi-CG", "S", 45, 18.9, "1e-6"},
      {"Vega, warped, Jacobi-CG", "S", 30.6, none, "1e-3"},
      {"Vega, warped, Jacobi-CG", "M", 202, 61, "1e-6"},
      {"Vega, warped, Jacobi-CG", "M", 125, none, "1e-3"},
      {"Vega, warped, Jacobi-CG", "L", 932, 218, "1e-6"},
      {"Bullet, float, matrix-free CG", "S", 57, 19, "default"},
      {"Bullet, float, matrix-free CG", "S", 32, none, "1e-3"},
      {"Bullet, float, matrix-free CG", "M", 221, 62, "default"},
      {"Bullet, float, matrix-free CG", "L", 1115, none, "default"},
      {"FastCorotatedFEM, float, one pass", "S", 1.4, 1.4, "none"},
      {"FastCorotatedFEM, float, one pass", "M", 5.7, 5.9, "none"},
      {"FastCorotatedFEM, float, one pass", "L", 28, 41, "none"},
  };
  return figures;
}

double reference_bandwidth_gb_s(int threads) { return threads == 1 ? 12.8 : 25.0; }

}  // namespace palpate::study
