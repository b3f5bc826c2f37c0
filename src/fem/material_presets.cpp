// Materials with published values.  Every figure has its source; nothing is fitted to simulations.  The
// moduli, viscosity, exponent and storage share below stand in the abstracts of the papers; densities in the
// tables that are named; those of rubber on MatWeb's page.
//
// Young's modulus.  Elastography measures the shear modulus mu of tissue that is nearly incompressible, so
// that E = 3 mu.  Poisson's ratio: all sources take their material for incompressible.  Plain tetrahedra lock
// from 0.45 on (docs/writing-scenes.md), so presets have 0.45; the error of a Hertz contact is then
// (1 - 0.5^2) / (1 - 0.45^2) - 1 = -6 % of the force at the same E.
//
// Damping.  palpate's solids are of Kelvin and Voigt: mu (1 + i w beta), with loss factor w beta.
// - A Zener solid, mu_1 in parallel to mu_2 and eta in series, is mu_1 + i w eta for w << mu_2/eta: then
//   beta = eta/mu_1.
// - A spring-pot, (i w)^a, has the loss factor tan(a pi/2) at all frequencies: then beta = tan(a pi/2)/w at
//   the frequency of the measurement, and mu = |G| / sqrt(1 + tan(a pi/2)^2).
// - A storage modulus of at least a share s of the complex modulus bounds the loss factor by
//   sqrt(1/s^2 - 1).
#include "palpate/fem/material_presets.h"

#include "palpate/core/error.h"

namespace palpate::fem {
namespace {

constexpr double kRatio = 0.45;  // see above

Material material(double youngs_modulus, double density, double stiffness_damping) {
  return {youngs_modulus, kRatio, density, 0.0, stiffness_damping};
}

}  // namespace

const std::vector<MaterialPreset>& material_presets() {
  static const std::vector<MaterialPreset> presets{
      {"fat", "gluteal fat of 10 women, in vivo, at 50 Hz",
       "|G| = 752 Pa: Hatt et al. 2023, J. Mech. Behav. Biomed. Mater.; damping: upper bound (loss factor "
       "0.39), from a storage modulus of over 93 % of the complex one in breast and prostate, Krouskop et "
       "al. "
       "1998, Ultrason. Imaging 20:260; density: adipose tissue of phantoms, Rep. Pract. Oncol. Radiother. "
       "19:392, 2014",
       material(2100.0, 950.0, 1.3e-3)},  // 3 * 752 / sqrt(1 + 0.39^2), 0.39/(2 pi 50), sqrt(1/0.93^2 - 1)
      {"liver", "liver of 8 healthy adults, in vivo, valid below 40 Hz",
       "mu_1 = 1.16 kPa, mu_2 = 1.97 kPa and viscosity 7.3 Pa s: Asbach et al. 2008, Magn. Reson. Med. "
       "60:373; density: table 1 of Phys. Med. Biol. 64:225001, 2019, after Duck",
       material(3500.0, 1060.0, 6.3e-3)},  // 3 * 1160, 7.3/1160; mu_2/(2 pi eta) = 43 Hz
      {"muscle", "relaxed gluteal muscle of 10 women, in vivo, at 50 Hz",
       "|G| = 1000 Pa: Hatt et al. 2023, J. Mech. Behav. Biomed. Mater.; damping: spring-pot exponent 0.253 "
       "of relaxed thigh muscle, Klatt et al. 2010, Phys. Med. Biol. 55:6445; density: muscle of phantoms, "
       "Rep. Pract. Oncol. Radiother. 19:392, 2014",
       material(2800.0, 1050.0, 1.3e-3)},  // 3000 / sqrt(1 + 0.42^2), tan(0.253 pi/2)/(2 pi 50)
      {"silicone", "polydimethylsiloxane at room temperature",
       "G = 250 kPa at all frequencies: Loetters et al. 1997, J. Micromech. Microeng. 7:145; damping (0) and "
       "density are not from a publication: set yours",
       material(7.5e5, 970.0, 0.0)},
      {"rubber", "vulcanised natural rubber",
       "G = 0.5 MPa, and density without fillers: MatWeb, Natural Rubber, Vulcanized (NR, IR, Polyisoprene); "
       "no figure of damping adopted (0)",
       material(1.5e6, 950.0, 0.0)},
  };
  return presets;
}

const MaterialPreset& material_preset(const std::string& name) {
  std::vector<std::string> known;
  for (const MaterialPreset& preset : material_presets()) {
    if (preset.name == name) return preset;
    known.push_back(preset.name);
  }
  fail("unknown material \"{}\"{}", name, suggestion(name, known));
}

}  // namespace palpate::fem
