#pragma once
#include "palpate/scene/description.h"
#include "scene/document.h"

/// What one key alone cannot tell: names that refer to one another, keys that exclude or need one another,
/// times that must divide. Each throws Error with the location of the key at fault.
namespace palpate::scene {

void check(const Document& document, Description& description);

void check_keyframes(const Document& document, const std::string& key, const std::string& where,
                     const std::vector<KeyframeSpec>& frames);
void check_box(const Document& document, const std::string& key, const std::string& where, const Vec3& low,
               const Vec3& high);
void check_bones(const Document& document, const Description& description);
/// also says by which keys each chooses its nodes
void check_attachments(const Document& document, Description& description);
/// also says by which keys each chooses its elements
void check_regions(const Document& document, Description& description);
void check_skeletons(const Document& document, const Description& description);
void check_meshes(const Document& document, const Description& description);
/// also puts the soft body first in each pair
void check_contacts(const Document& document, Description& description);

/// What picks nodes or elements of a body: "box", "sphere", or "" where neither is given.  @throws Error
/// where both are, or one by halves
std::string box_or_sphere(const Document& doc, const std::string& key, const std::string& where);

}  // namespace palpate::scene
