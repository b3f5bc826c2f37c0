#pragma once
#include "palpate/scene/description.h"
#include "scene/reader.h"

/// Every key of a scene file, as data.  A field added to a spec gets one line here.
namespace palpate::scene {

const KeyTable<Description>& description_keys();  ///< the file itself
const KeyTable<SoftBodySpec>& body_keys();        ///< [[body]]
const KeyTable<BoneSpec>& bone_keys();            ///< [[bone]]
const KeyTable<DeviceSpec>& device_keys();        ///< [device]
const KeyTable<MeshSpec>& mesh_keys();            ///< [body.mesh], [tool.mesh]
/// [[device.keyframe]], [[body.attachment.keyframe]], [[body.skeleton.joint.keyframe]], [[bone.keyframe]]
const KeyTable<KeyframeSpec>& keyframe_keys();

}  // namespace palpate::scene
