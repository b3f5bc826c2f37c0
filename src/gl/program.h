#pragma once
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "palpate/core/types.h"

namespace palpate::gl {

/// Returns the source of a file under shaders/, embedded at build time: shader_source("contact/skin.vert").
/// To add a shader, add its file.
/// @throws InternalError for an unknown name
std::string_view shader_source(std::string_view name);
/// Returns the names of all embedded shaders.
std::vector<std::string> shader_names();

/// Linked GLSL program.  All functions require the context to be current.
class Program {
 public:
  /// Links vertex and fragment shader given by embedded name.
  Program(std::string_view vertex, std::string_view fragment);
  /// Links a compute shader given by embedded name.
  explicit Program(std::string_view compute);
  ~Program();
  Program(Program&& other) noexcept;
  Program& operator=(Program&& other) noexcept;

  void use() const;
  unsigned id() const { return id_; }
  /// Sets a uniform; the program need not be in use.  @throws InternalError for a name that the linked
  /// program does not have
  void set(const std::string& name, int value);
  void set(const std::string& name, unsigned value);
  void set(const std::string& name, float value);
  void set(const std::string& name, const Eigen::Vector2f& value);
  void set(const std::string& name, const Eigen::Vector3f& value);
  void set(const std::string& name, const Eigen::Vector4f& value);
  void set(const std::string& name, std::span<const Eigen::Vector4f> values);  ///< Sets an array.
  void set(const std::string& name, const Eigen::Matrix3f& value);
  void set(const std::string& name, const Eigen::Matrix4f& value);

 private:
  int location(const std::string& name);
  unsigned id_ = 0;
  std::string name_;
  std::unordered_map<std::string, int> locations_;
};

}  // namespace palpate::gl
