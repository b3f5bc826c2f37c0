#pragma once
#include "render/camera.h"

namespace palpate::render {

/// Returns the camera axes; columns: right, up, backwards (from the scene to the eye).
Mat3 camera_axes(const Vec3& backwards, const Vec3& up);

/// Returns the unit vector from the scene to the eye.
Vec3 backwards_of(const View& view);

}  // namespace palpate::render
