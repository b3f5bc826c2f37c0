#pragma once

/// Makes contact sources: of exact shapes, in image space, and by nearest points.
#include "contact/distance_source.h"
#include "contact/half_and_half.h"
#include "contact/make_image_source.h"
#include "contact/material_points.h"
#include "contact/obstacles/box.h"
#include "contact/obstacles/cylinder.h"
#include "contact/obstacles/plane.h"
#include "contact/obstacles/sphere.h"
