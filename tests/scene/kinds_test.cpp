// Keys that a method, an obstacle, a generator or a device does not use are rejected, according to the
// registries.
#include <gtest/gtest.h>

#include <algorithm>

#include "loop/registries.h"
#include "palpate/core/error.h"
#include "palpate/fem/material_presets.h"
#include "palpate/loop/load.h"
#include "scene/scene_texts.h"

using palpate::loop::parse;
using palpate::scene::Description;

namespace {

using Overrides = std::vector<std::string>;

const std::string kBlock = R"([scene]
name = "block"
duration_s = 0.1
[[body]]
name = "block"
youngs_modulus_pa = 1e4
mesh = { generator = "box", size_m = [0.1, 0.1, 0.1], element_size_m = 0.1 }
)";

std::string with_integrator(const std::string& keys) { return kBlock + "[integrator]\n" + keys; }

std::string refusal(const std::string& text, const Overrides& overrides = {}) {
  try {
    parse(text, "s.toml", overrides);
  } catch (const palpate::Error& e) { return e.what(); }
  return "accepted";
}

TEST(Kinds, AKeyThatTheIntegratorDoesNotUseIsRefusedAtItsLocation) {
  EXPECT_EQ(refusal(with_integrator("name = \"rk4\"\nstep_s = 1e-4\nspectral_radius = 0.5\n")),
            "s.toml:11:19: integrator: spectral_radius does not apply to integrator \"rk4\", which takes "
            "step_s, max_steps, threads; remove it (used by generalized-alpha)");
  EXPECT_EQ(refusal(kBlock, {"integrator.name=rk4", "integrator.spectral_radius=0.5"}),
            "--set integrator.spectral_radius=0.5: integrator: spectral_radius does not apply to integrator "
            "\"rk4\", which takes step_s, max_steps, threads; remove it (used by generalized-alpha)");
  EXPECT_EQ(refusal(kBlock, {"integrator.spectral_radius=0.5", "integrator.name=generalized-alpha"}),
            "accepted");
  const std::pair<const char*, const char*> unused[] = {
      {"name = \"cvode-bdf\"\nstep_s = 1e-3", "step_s does not apply to integrator \"cvode-bdf\""},
      {"step_s = 1e-3", "step_s does not apply to integrator \"cvode-bdf\""},
      {"name = \"rk4\"\nrtol = 1e-3", "rtol does not apply to integrator \"rk4\""},
      {"name = \"rk4\"\nlinear_solver = \"cholmod\"", "linear_solver does not apply to integrator \"rk4\""},
      {"name = \"rk4\"\nlinear_rtol = 1e-6",
       "linear_rtol does not apply to a method without a linear solver"},
      {"name = \"cvode-bdf\"\nlinear_rtol = 1e-6", "linear_rtol does not apply to linear solver \"cholmod\""},
      {"name = \"linearly-implicit-euler\"\nnewton_rtol = 1e-6", "newton_rtol does not apply to"},
      {"name = \"linearly-implicit-euler\"\nfixed_step = true", "fixed_step does not apply to"},
      {"name = \"ark-dirk-esdirk547\"\nexplicit_side = \"contact\"", "explicit_side does not apply to"},
      {"name = \"ark-dirk-esdirk547\"\nmax_order = 3", "max_order does not apply to"},
  };
  for (const auto& [keys, expected] : unused) {
    const std::string message = refusal(with_integrator(keys));
    EXPECT_NE(message.find(expected), std::string::npos) << keys << "\n" << message;
    EXPECT_TRUE(message.starts_with("s.toml:")) << message;
  }
  for (const char* used :
       {"name = \"linearly-implicit-euler\"\nlinear_rtol = 1e-6", "name = \"rk4\"\nthreads = 2",
        "name = \"cvode-bdf\"\nlinear_solver = \"pcg\"\nlinear_rtol = 1e-6",
        "name = \"backward-euler\"\nfactor_kept_steps = 3\nnewton_rtol = 1e-9"})
    EXPECT_EQ(refusal(with_integrator(used)), "accepted") << used;
}

// The registry's list is decisive for each method: a key of [integrator] is either in it or rejected.
TEST(Kinds, EveryIntegratorRefusesEveryKeyThatItDoesNotList) {
  const auto rows = palpate::scene::key_rows(palpate::loop::kinds());
  int refused = 0, taken = 0;
  for (const auto& entry : palpate::loop::steppers())
    for (const auto& row : rows) {
      if (row.table != "integrator" || row.name == "name" || row.name == "linear_rtol") continue;
      const std::string value = row.is_value ? row.fallback : "\"cholmod\"",
                        message = refusal(with_integrator("name = \"" + entry.name + "\"\n" + row.name +
                                                          " = " + value + "\n"));
      const bool listed = std::any_of(entry.keys.begin(), entry.keys.end(),
                                      [&](const auto& key) { return key.name == row.name; });
      if (listed)
        EXPECT_EQ(message, "accepted") << entry.name << ", " << row.name;
      else
        EXPECT_NE(
            message.find(row.name + " does not apply to integrator \"" + entry.name + "\", which takes"),
            std::string::npos)
            << entry.name << ", " << row.name << ": " << message;
      ++(listed ? taken : refused);
    }
  EXPECT_GT(refused, 100);
  EXPECT_GT(taken, 100);
}

TEST(Kinds, RangesAreThoseOfTheMethod) {
  EXPECT_EQ(refusal(with_integrator("name = \"linearly-implicit-euler\"\nlinear_rtol = 0.5\n")),
            "s.toml:10:15: integrator: linear_rtol = 0.5 must lie in [1e-15, 0.1]; 1e-8 is usual");
  EXPECT_EQ(refusal(with_integrator("max_order = 6\n")),
            "s.toml:9:13: integrator: max_order = 6 must lie in [0, 5]; with 0 the method chooses the order");
  EXPECT_EQ(refusal(with_integrator("name = \"cvode-adams\"\nmax_order = 6\n")), "accepted");
  EXPECT_NE(refusal(with_integrator("rtol = 0.5\n")).find("rtol = 0.5 must lie in (0, 0.1]; 1e-3 is usual"),
            std::string::npos);
}

TEST(Kinds, UnknownNamesAreRefusedAtTheirLocation) {
  EXPECT_EQ(refusal(with_integrator("name = \"rk5\"\n")),
            "s.toml:9:8: integrator: name = \"rk5\" is not known (did you mean \"rk4\"?)");
  EXPECT_NE(
      refusal(with_integrator("linear_solver = \"pgc\"\n")).find("linear_solver = \"pgc\" is not known"),
      std::string::npos);
  EXPECT_NE(refusal(kBlock, {"body.0.material=steel"}).find("material = \"steel\" is not known"),
            std::string::npos);
  EXPECT_NE(refusal(scene_texts::kWhole, {"device.type=scirpt"}).find("did you mean \"script\"?"),
            std::string::npos);
}

TEST(Kinds, AMaterialGivesTheValuesThatTheTableDoesNotHave) {
  std::string text = kBlock;
  const std::string modulus = "youngs_modulus_pa = 1e4\n";
  text.replace(text.find(modulus), modulus.size(), "material = \"liver\"\ndensity_kg_m3 = 900.0\n");
  const palpate::SoftBodySpec body = parse(text, "s.toml").bodies.at(0);
  const palpate::fem::Material& liver = palpate::fem::material_preset("liver").material;
  EXPECT_EQ(body.material, "liver");
  EXPECT_EQ(body.youngs_modulus_pa, liver.youngs_modulus);
  EXPECT_EQ(body.poissons_ratio, liver.poissons_ratio);
  EXPECT_EQ(body.stiffness_damping_s, liver.stiffness_damping);
  EXPECT_EQ(body.density_kg_m3, 900.0) << "a key beside the material takes precedence";
  EXPECT_EQ(parse(text, "s.toml", {"body.0.youngs_modulus_pa=5e3"}).bodies[0].youngs_modulus_pa, 5e3);
  EXPECT_EQ(parse(text, "s.toml", {"body.0.material=\"fat\""}).bodies[0].youngs_modulus_pa,
            palpate::fem::material_preset("fat").material.youngs_modulus);
  EXPECT_NE(refusal(kBlock, {"body.0.material=corotational"}).find("write law = \"corotational\""),
            std::string::npos);
  EXPECT_NE(refusal(kBlock + "[[body.region]]\nname = \"r\"\nmaterial = \"livr\"\n")
                .find("did you mean \"liver\"?"),
            std::string::npos);
}

// Keys of the file's method are ignored when an override replaces the method.
TEST(Kinds, AnotherMethodTakesOnlyTheKeysThatItUses) {
  const std::string own = with_integrator(
      "name = \"generalized-alpha\"\nstep_s = 2e-3\nspectral_radius = 0.5\nlinear_solver = \"pcg\"\n"
      "linear_rtol = 1e-6\n");
  EXPECT_TRUE(parse(own, "s.toml").not_carried_over.empty());
  const Description rk4 = parse(own, "s.toml", {"integrator.name=\"rk4\""});
  EXPECT_EQ(rk4.not_carried_over,
            (std::vector<std::string>{"integrator.linear_solver", "integrator.spectral_radius",
                                      "integrator.linear_rtol"}));
  EXPECT_EQ(rk4.integrator.step_s, 2e-3) << "used by both";
  EXPECT_EQ(rk4.integrator.spectral_radius, palpate::IntegratorSpec{}.spectral_radius);
  EXPECT_EQ(rk4.source.find("spectral_radius"), std::string::npos);
  EXPECT_EQ(refusal(rk4.source), "accepted") << "the source that is kept is a scene";
  EXPECT_EQ(parse(own, "s.toml", {"integrator.linear_solver=cholmod"}).not_carried_over,
            std::vector<std::string>{"integrator.linear_rtol"});
  EXPECT_NE(
      refusal(own, {"integrator.name=rk4", "integrator.max_order=2"}).find("max_order does not apply to"),
      std::string::npos)
      << "what is said for the new one counts";
  EXPECT_NE(refusal(own + "max_order = 2\n", {"integrator.name=generalized-alpha"})
                .find("max_order does not apply"),
            std::string::npos)
      << "the same method";
}

TEST(Kinds, EveryIntegratorTakesEverySceneThatComesWithPalpate) {
  int loaded = 0;
  for (const std::string& path : scene_texts::in_folder(scene_texts::kScenes))
    for (const auto& entry : palpate::loop::steppers()) {
      const Description d = palpate::loop::load(path, {"integrator.name=\"" + entry.name + "\""});
      EXPECT_EQ(d.integrator.name, entry.name);
      EXPECT_EQ(refusal(d.source), "accepted") << path << ", " << entry.name;
      ++loaded;
    }
  EXPECT_GT(loaded, 100);
}

TEST(Kinds, Obstacles) {
  const auto with = [](const std::string& keys) {
    return refusal(kBlock + "[[obstacle]]\nname = \"thing\"\n" + keys);
  };
  EXPECT_EQ(with("type = \"sphere\"\nradius_m = 0.1\nsize_m = [1, 1, 1]\n"),
            "s.toml:12:10: obstacle \"thing\": size_m does not apply to type = \"sphere\", which takes "
            "position_m, radius_m; remove it (used by box)");
  EXPECT_EQ(with("type = \"sphere\"\n"),
            "s.toml:8:1: obstacle \"thing\": radius_m is missing: type = \"sphere\" needs it");
  EXPECT_EQ(with("type = \"sphere\"\nradius = 0.1\n"),
            "s.toml:11:1: obstacle \"thing\": unknown key \"radius\" (did you mean \"radius_m\"?)");
  EXPECT_EQ(
      with("type = \"sphere\"\nradius_m = -0.1\n"),
      "s.toml:11:12: obstacle \"thing\": radius_m = -0.1 must lie in (0, 1000000); lengths are in metres");
  EXPECT_EQ(with("type = \"sphere\"\nradius_m = [1, 2, 3]\n"),
            "s.toml:11:12: obstacle \"thing\": radius_m = [1, 2, 3] must be a number");
  EXPECT_EQ(with("type = \"box\"\nsize_m = [[1], 2, 3]\n"),
            "s.toml:11:10: obstacle \"thing\": size_m = [[...], 2, 3] must be three numbers, [x, y, z]");
  EXPECT_EQ(with("type = \"plane\"\nnormal = [0, 0, 0]\n"),
            "s.toml:11:10: obstacle \"thing\": normal = [0, 0, 0] has no direction; [0, 0, 1] is up");
  EXPECT_EQ(with("type = \"spere\"\n"),
            "s.toml:10:8: obstacle \"thing\": type = \"spere\" is not known (did you mean \"sphere\"?)");
  EXPECT_EQ(with(""), "s.toml:8:1: obstacle \"thing\": type is missing and has no default");
  EXPECT_EQ(with("type = \"cylinder\"\nradius_m = 0.1\nlength_m = 1\nrotation_vector_rad = [0, 1, 0]\n"),
            "accepted");
}

TEST(Kinds, ContactMethods) {
  const auto with = [](const Overrides& overrides) { return refusal(scene_texts::kWhole, overrides); };
  EXPECT_EQ(with({"contact.1.pixels=128", "contact.1.method=analytic"}),
            "--set contact.1.pixels=128: contact between \"ball\" and \"tool\": pixels does not apply to "
            "method = \"analytic\"; remove it (used by auto, image)");
  EXPECT_EQ(with({"contact.1.pixels=128", "contact.1.method=image"}), "accepted");
  EXPECT_EQ(with({"contact.1.pixels=128", "contact.1.method=gpu"}),
            "--set contact.1.method=gpu: contact between \"ball\" and \"tool\": method = \"gpu\" has been "
            "renamed; use \"image\" (known: analytic, auto, distance, image)");
  EXPECT_EQ(
      with({"contact.1.method=vertex"}),
      "--set contact.1.method=vertex: contact between \"ball\" and \"tool\": method = \"vertex\" does not "
      "exist; \"analytic\" and \"image\" sample at vertices (known: analytic, auto, distance, image)");
  EXPECT_NE(with({"contact.1.method=spheres"})
                .find("method = \"spheres\" is not known (known: analytic, auto, distance, image)"),
            std::string::npos);
  EXPECT_NE(with({"compare.contact_methods=[\"analytic\", \"vertex\"]"})
                .find("compare: contact_methods = \"vertex\" does not exist; "),
            std::string::npos);
}

TEST(Kinds, IntegratorsOfAHapticComparisonAreKnownOnes) {
  EXPECT_NE(refusal(scene_texts::kWhole, {"compare.haptic.integrators=[\"cvode-bfd\"]"})
                .find("did you mean \"cvode-bdf\"?"),
            std::string::npos);
}

TEST(Kinds, SpringsOfAreaAndOfPoints) {
  const auto with = [](const Overrides& overrides) { return refusal(scene_texts::kWhole, overrides); };
  EXPECT_EQ(
      with({"contact.0.spring=per_point", "contact.0.stiffness_n_m=20.0", "contact.0.damping_n_s_m=1.0"}),
      "accepted");
  EXPECT_EQ(with({"contact.0.stiffness_pa_m=1e6", "contact.0.damping_pa_s_m=1.0"}), "accepted");
  EXPECT_NE(with({"contact.0.spring=per_point", "contact.0.stiffness_pa_m=1e6"})
                .find("stiffness_pa_m does not apply to spring = \"per_point\", which takes stiffness_n_m, "
                      "damping_n_s_m; remove it (used by per_area)"),
            std::string::npos);
  EXPECT_NE(
      with({"contact.0.stiffness_n_m=20.0"}).find("stiffness_n_m does not apply to spring = \"per_area\""),
      std::string::npos);
  EXPECT_NE(with({"contact.0.spring=per_point", "contact.0.law=hunt_crossley", "contact.0.damping_n_s_m=1.0"})
                .find("damping_n_s_m does not apply to law = \"hunt_crossley\""),
            std::string::npos);
  EXPECT_NE(
      with({"contact.0.spring=steel"}).find("spring = \"steel\" is not known (known: per_area, per_point)"),
      std::string::npos);
  EXPECT_NE(with({"contact.0.spring=per_point", "contact.0.stiffness_n_m=0.0"}).find("must be positive"),
            std::string::npos);
  // the tool is a sphere, with exact gaps at the vertices; an image must be requested for vertex samples
  EXPECT_EQ(with({"contact.1.spring=per_point"}), "accepted");
  EXPECT_EQ(with({"contact.1.spring=per_point", "contact.1.method=image"}), "accepted");
}

TEST(Kinds, AFrictionTangentBelongsToFriction) {
  EXPECT_EQ(refusal(scene_texts::kWhole, {"contact.0.friction=0.3", "contact.0.friction_tangent=full"}),
            "accepted");
  EXPECT_NE(refusal(scene_texts::kWhole, {"contact.0.friction=0.3", "contact.0.friction_tangent=symetric"})
                .find("did you mean \"symmetric\""),
            std::string::npos);
  EXPECT_EQ(refusal(scene_texts::kWhole, {"contact.0.friction_tangent=full"}),
            "--set contact.0.friction_tangent=full: contact between \"floor\" and \"ball\": friction_tangent "
            "does not apply where friction = 0; remove it, or set friction");
  const std::string text = kBlock +
                           "[[obstacle]]\nname = \"floor\"\ntype = \"plane\"\n[[contact]]\nbetween = "
                           "[\"block\", \"floor\"]\nfriction_tangent = \"full\"\n";
  EXPECT_NE(
      refusal(text).find("s.toml:13:20: contact between \"block\" and \"floor\": friction_tangent does"),
      std::string::npos)
      << refusal(text);
  EXPECT_EQ(refusal(text + "friction = 0.3\n", {"contact.0.friction=0.0"}), "accepted")
      << "a scene without its friction, by an override";
}

TEST(Kinds, ToolDeviceAndExchange) {
  const auto with = [](const Overrides& overrides) { return refusal(scene_texts::kWhole, overrides); };
  EXPECT_EQ(with({"exchange.linearisation=frozen"}), "accepted");
  EXPECT_EQ(
      with({"exchange.scheme=monolithic", "exchange.linearisation=frozen"}),
      "--set exchange.linearisation=frozen: exchange: linearisation does not apply to scheme = "
      "\"monolithic\", which takes exchange_period_s, contact_refresh_s; remove it (used by partitioned, "
      "auto)");
  EXPECT_EQ(with({"exchange.tunnelling=substep", "exchange.shortest_refresh_s=1e-4"}), "accepted");
  EXPECT_EQ(with({"exchange.shortest_refresh_s=1e-4"}),
            "--set exchange.shortest_refresh_s=1e-4: exchange: shortest_refresh_s does not apply to "
            "tunnelling = \"report\"; remove it (used by substep)");
  if (!palpate::loop::tool_steppers().empty()) {
    EXPECT_NE(with({"tool.integrator=linearly-implicit-eular"})
                  .find("tool: integrator = \"linearly-implicit-eular\" is not known (did you mean "
                        "\"linearly-implicit-euler\"?)"),
              std::string::npos)
        << with({"tool.integrator=linearly-implicit-eular"});
  }
  EXPECT_EQ(refusal(kBlock + "[tool]\n[device]\nmax_force_n = 1.0\n"),
            "s.toml:9:1: device: keyframe is missing: device type \"script\" needs it");
  EXPECT_NE(
      with({"device.max_force_n=-1"}).find("max_force_n = -1 must be positive; a desktop device reaches 3.3"),
      std::string::npos);
}

TEST(Kinds, Meshes) {
  const auto with = [](const Overrides& overrides) { return refusal(scene_texts::kWhole, overrides); };
  EXPECT_NE(with({"body.0.mesh.length_m=1.0"})
                .find("mesh: length_m does not apply to generator = \"ball\", which takes radius_m, "
                      "element_size_m, grading; remove it (used by cylinder)"),
            std::string::npos);
  EXPECT_NE(with({"body.0.mesh.generator=bal"}).find("did you mean \"ball\"?"), std::string::npos);
  EXPECT_NE(with({"body.0.mesh.generator=file"})
                .find("generator = \"file\" is not known (known: box, ball, cylinder, tet)"),
            std::string::npos)
      << "a file is named by its own key";
  const Overrides tool = {"tool.shape=mesh", "tool.inertia_kg_m2=[1,1,1]", "contact.1.method=image"};
  const auto tool_with = [&](const std::string& mesh) {
    Overrides all = tool;
    all.push_back("tool.mesh={" + mesh + "}");
    return with(all);
  };
  EXPECT_EQ(tool_with("generator = \"ball\", radius_m = 0.01, element_size_m = 0.005"), "accepted");
  EXPECT_NE(tool_with("generator = \"ball\", radius_m = 0.01, element_size_m = 0.005, grading = 2.0")
                .find("grading does not apply to generator = \"ball\", which takes radius_m, element_size_m; "
                      "remove it (used by box, cylinder)"),
            std::string::npos)
      << "a sphere of triangles has no inside to grade";
  EXPECT_NE(tool_with("generator = \"tet\", size_m = [1, 1, 1]").find("generator = \"tet\" is not known"),
            std::string::npos);
  EXPECT_NE(
      tool_with("file = \"a.obj\", radius_m = 1.0").find("radius_m does not apply to a mesh from a file"),
      std::string::npos);
}

/// A registry key that is in no table would reject nothing, and describe nothing.
TEST(Kinds, ListOnlyKeysThatThereAre) {
  const auto rows = palpate::scene::key_rows(palpate::loop::kinds());
  int keys = 0;
  for (const auto& table : palpate::loop::kinds())
    for (const auto& kind : table.kinds)
      for (const auto& key : kind.keys) {
        ++keys;
        // a further hand has the keys of the first, which are listed once
        const std::string listed = table.table.starts_with("hand.") ? table.table.substr(5) : table.table;
        EXPECT_TRUE(std::any_of(rows.begin(), rows.end(),
                                [&](const auto& row) { return row.table == listed && row.name == key.name; }))
            << table.table << ", " << kind.name << ": " << key.name;
      }
  EXPECT_GT(keys, 100);
}

}  // namespace
