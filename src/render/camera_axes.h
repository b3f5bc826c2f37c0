#pragma once
#include "palpate/render/camera.h"

namespace palpate::render {

/// Columns: right, up, backwards (from the scene to the eye).
Mat3 camera_axes(const Vec3& backwards, const Vec3& up);

/// From the scene to the eye; of length one.
Vec3 backwards_of(const View& view);

}  // namespace palpate::render
