#pragma once
#include "palpate/scene/study.h"
#include "scene/reader.h"

/// Every key of a study file, as data.
namespace palpate::scene {

const KeyTable<StudySpec>& study_file_keys();

}  // namespace palpate::scene
