#pragma once
#include <string>
#include <vector>

namespace palpate::scene {

/// Scene as a user specified it, and the changes to it.
struct SceneArguments {
  std::string scene;                   ///< Path or name; empty: made from a text, which checkpoints keep
  std::vector<std::string> overrides;  ///< Changes of keys: "body.0.youngs_modulus_pa=1e5"
  std::string integrator;              ///< Integrator that replaces the one of the scene; empty: unchanged

  /// Returns all changes as overrides.
  std::vector<std::string> changes() const;
};

}  // namespace palpate::scene
