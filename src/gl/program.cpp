#include "gl/program.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <utility>

#include "core/counters.h"
#include "gl/context.h"
#include "gl/embedded_shaders.h"
#include "gl/program_cache.h"
#include "palpate/core/error.h"

namespace palpate::gl {
namespace {

/// Returns the info log of a shader or program; their getters differ only by name.
template <class GetLength, class GetLog>
std::string info_log(unsigned id, GetLength get_length, GetLog get_log) {
  GLint length = 0;
  get_length(id, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
  get_log(id, length, nullptr, log.data());
  return log;
}

unsigned compile(GLenum stage, std::string_view name) {
  const std::string_view source = shader_source(name);
  const unsigned id = glCreateShader(stage);
  const char* text = source.data();
  const auto length = static_cast<GLint>(source.size());
  glShaderSource(id, 1, &text, &length);
  glCompileShader(id);
  GLint ok = 0;
  glGetShaderiv(id, GL_COMPILE_STATUS, &ok);
  PALPATE_CHECK(ok, "shader {} does not compile:\n{}", name, info_log(id, glGetShaderiv, glGetShaderInfoLog));
  return id;
}

struct Stage {
  GLenum kind;
  std::string_view name;
};

/// Loads a program from the cache, or else compiles and caches it.
unsigned make(const std::vector<Stage>& stages, const std::string& name) {
  std::string sources;
  for (const Stage& stage : stages) sources.append(shader_source(stage.name)).push_back('\0');
  const ProgramKey key = program_key(sources);
  const unsigned id = glCreateProgram();
  if (load_program(id, key)) return id;
  glProgramParameteri(id, GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
  for (const Stage& stage : stages) {
    const unsigned shader = compile(stage.kind, stage.name);
    glAttachShader(id, shader);
    glDeleteShader(shader);  // Deleted with the program.
  }
  glLinkProgram(id);
  GLint ok = 0;
  glGetProgramiv(id, GL_LINK_STATUS, &ok);
  PALPATE_CHECK(ok, "shader program {} does not link:\n{}", name,
                info_log(id, glGetProgramiv, glGetProgramInfoLog));
  counters::count("gl.program_compiled");
  keep_program(id, key);
  return id;
}

}  // namespace

std::string_view shader_source(std::string_view name) {
  for (const auto& shader : embedded_shaders())
    if (shader.name == name) return shader.source;
  PALPATE_CHECK(false, "no shader \"{}\" is embedded{}", name, suggestion(name, shader_names()));
  return {};
}

std::vector<std::string> shader_names() {
  std::vector<std::string> names;
  for (const auto& shader : embedded_shaders()) names.emplace_back(shader.name);
  return names;
}

Program::Program(std::string_view vertex, std::string_view fragment)
    : name_(std::string(vertex) + " + " + std::string(fragment)) {
  id_ = make({{GL_VERTEX_SHADER, vertex}, {GL_FRAGMENT_SHADER, fragment}}, name_);
}

Program::Program(std::string_view compute) : name_(compute) {
  id_ = make({{GL_COMPUTE_SHADER, compute}}, name_);
}

Program::~Program() {
  if (id_) Context::destroy(ObjectKind::kProgram, id_);
}

Program::Program(Program&& other) noexcept
    : id_(std::exchange(other.id_, 0)),
      name_(std::move(other.name_)),
      locations_(std::move(other.locations_)) {}

Program& Program::operator=(Program&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(name_, other.name_);
  std::swap(locations_, other.locations_);
  return *this;
}

void Program::use() const { glUseProgram(id_); }

int Program::location(const std::string& name) {
  const auto it = locations_.find(name);
  if (it != locations_.end()) return it->second;
  const int found = glGetUniformLocation(id_, name.c_str());
  PALPATE_CHECK(found >= 0, "shader program {} has no uniform \"{}\" (or the compiler removed it, unused)",
                name_, name);
  return locations_[name] = found;
}

void Program::set(const std::string& name, int value) { glProgramUniform1i(id_, location(name), value); }
void Program::set(const std::string& name, unsigned value) {
  glProgramUniform1ui(id_, location(name), value);
}
void Program::set(const std::string& name, float value) { glProgramUniform1f(id_, location(name), value); }
void Program::set(const std::string& name, const Eigen::Vector2f& v) {
  glProgramUniform2fv(id_, location(name), 1, v.data());
}
void Program::set(const std::string& name, const Eigen::Vector3f& v) {
  glProgramUniform3fv(id_, location(name), 1, v.data());
}
void Program::set(const std::string& name, const Eigen::Vector4f& v) {
  glProgramUniform4fv(id_, location(name), 1, v.data());
}
void Program::set(const std::string& name, std::span<const Eigen::Vector4f> v) {
  glProgramUniform4fv(id_, location(name), static_cast<GLsizei>(v.size()), v[0].data());
}
void Program::set(const std::string& name, const Eigen::Matrix3f& m) {
  glProgramUniformMatrix3fv(id_, location(name), 1, GL_FALSE, m.data());
}
void Program::set(const std::string& name, const Eigen::Matrix4f& m) {
  glProgramUniformMatrix4fv(id_, location(name), 1, GL_FALSE, m.data());
}

}  // namespace palpate::gl
