#pragma once
#include "experiments/compare/haptic_comparison.h"
#include "experiments/compare/monolithic.h"
#include "store/summary.h"

/// Results of comparisons in summary.json, by the keys of docs/files.md.
namespace palpate::compare {

/// Adds the reference of a run and the error of the wrench on each hand.
/// @param name  of the reference: "monolithic", "virtual_time"
void add_to_summary(store::Summary& summary, const scene::Description& description,
                    const AgainstReference& against, const std::string& name);

/// Adds the reference of a comparison, the observed orders, and the error at the settings of the scene.
void add_to_summary(store::Summary& summary, const scene::Description& description,
                    const HapticComparison& comparison);

}  // namespace palpate::compare
