#pragma once
#include "palpate/scene/description.h"
#include "scene/reader.h"

/// Every key of a scene file, as data.  A field added to a spec gets one line here.
namespace palpate::scene {

const KeyTable<Description>& description_keys();  ///< Top level of the file.
const KeyTable<SoftBodySpec>& body_keys();        ///< Table [[body]].
const KeyTable<BoneSpec>& bone_keys();            ///< Table [[bone]].
const KeyTable<DeviceSpec>& device_keys();        ///< Table [device].
const KeyTable<MeshSpec>& mesh_keys();            ///< Tables [body.mesh], [tool.mesh].
const KeyTable<ViewSpec>& view_keys();            ///< Table [view].
/// Tables [[device.keyframe]], [[body.attachment.keyframe]], [[body.skeleton.joint.keyframe]],
/// [[bone.keyframe]].
const KeyTable<KeyframeSpec>& keyframe_keys();

}  // namespace palpate::scene
