#pragma once
#include "palpate/scene/description.h"
#include "scene/document.h"

/// Checks across keys: names that refer to one another, keys that exclude or require one another, times that
/// must divide.  Each throws Error with the location of the faulty key.
namespace palpate::scene {

/// Runs all checks of a scene, and completes defaults that depend on other keys.
void check(const Document& document, Description& description);

/// Checks that keyframes are in ascending order of time.
void check_keyframes(const Document& document, const std::string& key, const std::string& where,
                     const std::vector<KeyframeSpec>& frames);
/// Checks that box_min_m <= box_max_m.
void check_box(const Document& document, const std::string& key, const std::string& where, const Vec3& low,
               const Vec3& high);
/// Checks shapes, masses and motions of bones.
void check_bones(const Document& document, const Description& description);
/// Checks attachments, and sets the way in which each selects its nodes.
void check_attachments(const Document& document, Description& description);
/// Checks regions and material changes, and sets the way in which each region selects its elements.
void check_regions(const Document& document, Description& description);
/// Checks skeletons and their joints.
void check_skeletons(const Document& document, const Description& description);
/// Checks meshes, skins and proxies of bodies and tools.
void check_meshes(const Document& document, const Description& description);
/// Checks contacts, puts each pair into canonical order, and resolves method = "auto".
void check_contacts(const Document& document, Description& description);

/// Returns the shape that selects nodes or elements of a body: box or sphere; empty where neither is given.
/// @throws Error where both are given, or one is incomplete
std::optional<Selection> box_or_sphere(const Document& doc, const std::string& key, const std::string& where);

}  // namespace palpate::scene
