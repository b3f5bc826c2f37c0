#pragma once
#include "scene/reader.h"
#include "scene/study_spec.h"

/// Every key of a study file, as data.
namespace palpate::scene {

const KeyTable<StudySpec>& study_file_keys();

}  // namespace palpate::scene
