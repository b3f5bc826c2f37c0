#pragma once
#include <string>

#include "palpate/loop/world.h"

/// Scene that touches a mesh, for `palpate new`: every number follows from the mesh and the material by a
/// rule that stands beside it in the scene (docs/writing-scenes.md).
namespace palpate::loop {

/// Input of the rules.
struct NewScene {
  std::string name;                     ///< Name of the scene and of the body
  std::string title;                    ///< First line of the comment: what the scene touches
  std::string command;                  ///< Command line that made the scene
  std::string file;                     ///< Key mesh.file: relative to the scene's folder, or "model:NAME"
  double scale = 1.0;                   ///< Key mesh.scale; 1: omitted
  bool scale_given = false;             ///< Whether the scene states the factor although it is 1
  bool skin = false;                    ///< Whether the file is a model with a skin
  Vec3 rotation_vector = Vec3::Zero();  ///< Initial rotation of the mesh [rad]
  std::string material;                 ///< Name in fem::material_presets()
  double tool_radius = 0.0;             ///< [m]; 0: by rule
};

/// Returns the description with only the body, from which the rules take its measures.
scene::Description body_alone(const NewScene& choice, const std::string& path);

/// Returns the scene as TOML with comments.
/// @param body  as assembled from body_alone()
/// @throws Error where the body has no volume
std::string new_scene_text(const NewScene& choice, const Body& body);

}  // namespace palpate::loop
