#pragma once
#include <pybind11/pybind11.h>

/// Binding functions, one per source file; module.cpp calls them in this order.
namespace palpate::python {

void bind_scene(pybind11::module_& module);
void bind_body(pybind11::module_& module);
void bind_body_state(pybind11::module_& module);
void bind_bone(pybind11::module_& module);
void bind_handle_pose(pybind11::module_& module);
void bind_hand(pybind11::module_& module);
void bind_contact(pybind11::module_& module);
void bind_simulation(pybind11::module_& module);
void bind_runs(pybind11::module_& module);
void bind_studies(pybind11::module_& module);

}  // namespace palpate::python
