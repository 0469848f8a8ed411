#include "server/limit_list.h"

namespace linetree {
namespace {

std::vector<NamedLimit> ListRender(const RenderLimits& limits) {
  const auto& [max_side, max_pixels, max_samples, max_rays] = limits;
  return {
      {"render.max_side", static_cast<uint64_t>(max_side), "columns, and rows, of a frame"},
      {"render.max_pixels", max_pixels, "pixels of a frame"},
      {"render.max_samples", max_samples, "samples of all pixels of a frame together"},
      {"render.max_rays", max_rays, "rays of a batch"},
  };
}

std::vector<NamedLimit> ListScene(const SceneLimits& limits) {
  const auto& [max_objects, max_materials, max_lights, max_cameras, max_polygon_vertices,
               max_half_spaces, max_file_bytes] = limits;
  return {
      {"scene.max_objects", max_objects, "objects of a scene"},
      {"scene.max_materials", max_materials, "materials of a scene"},
      {"scene.max_lights", max_lights, "lights of a scene"},
      {"scene.max_cameras", max_cameras, "cameras of a scene"},
      {"scene.max_polygon_vertices", max_polygon_vertices, "vertices of a polygon"},
      {"scene.max_half_spaces", max_half_spaces, "half-spaces of a polyhedron"},
      {"scene.max_file_bytes", max_file_bytes, "bytes of a scene's text"},
  };
}

}  // namespace

std::vector<NamedLimit> ListLimits(const ServerLimits& limits) {
  const auto& [render, max_message_bytes, max_scene_bytes, max_scene_messages, max_batch_bytes,
               max_request_bytes, scene, max_scenes, max_objects_in_all_scenes, max_waiting_renders,
               max_waiting_rays, max_waiting_loads, max_flights, max_pending_viewpoints,
               max_streams_per_connection, max_frame_bytes, max_warm_up_frames, max_waiting_audits,
               retry_after_ms] = limits;
  std::vector<NamedLimit> list = ListRender(render);
  for (const NamedLimit& limit : ListScene(scene)) list.push_back(limit);
  const NamedLimit others[] = {
      {"max_message_bytes", static_cast<uint64_t>(max_message_bytes), "bytes of any request"},
      {"max_scene_bytes", max_scene_bytes, "bytes of a LoadSceneRequest or an UpdateSceneRequest"},
      {"max_scene_messages", max_scene_messages, "messages within one of them"},
      {"max_batch_bytes", max_batch_bytes, "bytes of a TraceRaysRequest"},
      {"max_request_bytes", max_request_bytes, "bytes of every other request"},
      {"max_scenes", max_scenes, "scenes that are held"},
      {"max_objects_in_all_scenes", max_objects_in_all_scenes, "objects of all scenes together"},
      {"max_waiting_renders", max_waiting_renders, "frames and batches that wait to be worked on"},
      {"max_waiting_rays", max_waiting_rays, "rays of these together"},
      {"max_waiting_loads", max_waiting_loads, "scenes that wait to be built"},
      {"max_flights", max_flights, "flights at a time"},
      {"max_pending_viewpoints", max_pending_viewpoints,
       "viewpoints that a flight may send ahead before the server stops reading"},
      {"max_streams_per_connection", static_cast<uint64_t>(max_streams_per_connection),
       "calls at a time on one connection"},
      {"max_frame_bytes", max_frame_bytes, "bytes of all frames in work or being sent"},
      {"max_warm_up_frames", max_warm_up_frames, "frames of a warm-up"},
      {"max_waiting_audits", max_waiting_audits, "answers that wait for the audit"},
      {"retry_after_ms", static_cast<uint64_t>(retry_after_ms.count()),
       "milliseconds after which a caller that was refused for want of room should come back"},
  };
  list.insert(list.end(), std::begin(others), std::end(others));
  return list;
}

}  // namespace linetree
