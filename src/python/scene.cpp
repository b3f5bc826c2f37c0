#include "scene.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <map>

#include "bindings.h"
#include "palpate/loop/load.h"

namespace py = pybind11;

namespace palpate::python {

Scene Scene::load(const std::string& path) {
  Scene out;
  out.path_ = path;
  out.description_ = loop::load(path);
  out.text_ = out.description_.source;
  out.from_file_ = true;
  return out;
}

Scene Scene::parse(const std::string& text, const std::string& path,
                   const std::vector<std::string>& changes) {
  Scene out;
  out.path_ = path;
  out.text_ = text;
  out.changes_ = changes;
  out.description_ = loop::parse(text, path, changes);
  return out;
}

void Scene::set(const std::vector<std::string>& more) {
  std::vector<std::string> changes = changes_;
  changes.insert(changes.end(), more.begin(), more.end());
  Scene changed = parse(text_, path_, changes);
  changed.from_file_ = from_file_;
  *this = std::move(changed);
}

namespace {

/// Converts Python values to TOML with the package's writer.
std::string toml_of(const char* writer, const py::object& value) {
  return py::module_::import("palpate._toml").attr(writer)(value).cast<std::string>();
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<Scene>(
      module, "Scene",
      "A scene, given by a TOML file or by a dict of the same structure.\n\n"
      "Scene({\"scene\": {\"duration_s\": 0.1}, \"body\": [{...}]}); meshes are looked for in `folder`.")
      .def(py::init([](const py::dict& tables, const std::filesystem::path& folder) {
             return Scene::parse(toml_of("document", tables), (folder / "dict").string());
           }),
           py::arg("tables"), py::arg("folder") = "")
      .def_static("parse", &Scene::parse, py::arg("text"), py::arg("path") = "scene",
                  py::arg("changes") = std::vector<std::string>{},
                  "A scene from the text of a TOML file; meshes are looked for in the folder of `path`.")
      .def(
          "set",
          [](Scene& self, const std::string& path, const py::object& value) {
            self.set({path + "=" + toml_of("value", value)});
          },
          py::arg("path"), py::arg("value"),
          "Changes one key by its dotted path, as --set does: scene.set(\"body.0.youngs_modulus_pa\", 2e4).\n"
          "A rejected change leaves the scene unchanged.")
      .def(
          "set_all",
          [](Scene& self, const std::map<std::string, py::object>& values) {
            std::vector<std::string> changes;
            for (const auto& [path, value] : values) changes.push_back(path + "=" + toml_of("value", value));
            self.set(changes);
          },
          py::arg("values"), "Changes several keys, {path: value}, that are checked together.")
      .def(
          "copy", [](const Scene& self) { return self; }, "An independent copy.")
      .def_property_readonly("name", [](const Scene& self) { return self.description().name; })
      .def_property_readonly("path", [](const Scene& self) { return self.description().path; })
      .def_property_readonly("duration_s", [](const Scene& self) { return self.description().duration_s; })
      .def_property_readonly(
          "toml", [](const Scene& self) { return self.description().source; },
          "The scene as TOML, changes applied.")
      .def_property_readonly("text", &Scene::text, "The TOML before changes.")
      .def_property_readonly("changes", &Scene::changes, "Changes made by set(), as PATH=VALUE.")
      .def_property_readonly(
          "not_carried_over", [](const Scene& self) { return self.description().not_carried_over; },
          "Keys that are ignored, because they do not apply to the choices made by set().")
      .def("__repr__", [](const Scene& self) {
        return "<palpate.Scene \"" + self.description().name + "\" of " + self.description().path + ">";
      });
  module.def(
      "load", [](const std::filesystem::path& path) { return Scene::load(path.string()); }, py::arg("path"),
      "Reads and checks a scene file (TOML).");
}

}  // namespace palpate::python
