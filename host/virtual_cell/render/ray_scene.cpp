#include "virtual_cell/render/ray_scene.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "virtual_cell/render/embree.hpp"

namespace beltpick::virtual_cell {
namespace {

RTCRay make_ray(const Vec3f& origin, const Vec3f& direction, float near, float far) {
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tnear = near;
  ray.tfar = far;
  ray.mask = ~0U;
  return ray;
}

// The triangles of one part in a scene of their own, to be instanced.
RTCScene make_part_scene(RTCDevice device, const Mesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.vertex_mm.size()));
  for (std::size_t i = 0; i < mesh.vertex_mm.size(); ++i) Eigen::Map<Vec3f>(vertices + 3 * i) = mesh.vertex_mm[i];
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.face.size()));
  for (std::size_t i = 0; i < mesh.face.size(); ++i) std::copy_n(mesh.face[i].data(), 3, indices + 3 * i);
  rtcCommitGeometry(geometry);
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

}  // namespace

struct RayScene::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<RTCScene> part_scenes;
  std::vector<ScenePart> parts;
  std::vector<PartInstance> instances;
  std::vector<Pose<frame::Part, frame::Camera>> T_part_camera;
  Pose<frame::Belt, frame::Camera> T_belt_camera;
  Vec3f belt_normal = Vec3f::UnitZ();
  float belt_offset = 0.0F;

  // Distance along the ray to the belt, negative for none.
  [[nodiscard]] float to_belt(const Vec3f& origin, const Vec3f& direction) const {
    const float speed = belt_normal.dot(direction);
    return std::abs(speed) < 1e-9F ? -1.0F : (belt_offset - belt_normal.dot(origin)) / speed;
  }

  [[nodiscard]] Vec3f smooth_normal(const RTCHit& hit, const PartInstance& instance) const {
    const auto& corner = parts[instance.part].corner_normal;
    const std::size_t first = 3 * static_cast<std::size_t>(hit.primID);
    const Vec3f normal = (1.0F - hit.u - hit.v) * corner[first] + hit.u * corner[first + 1] + hit.v * corner[first + 2];
    return (instance.T_camera_part.rotation.cast<float>() * normal).normalized();
  }
};

RayScene::RayScene(std::span<const ScenePart> parts, const Pose<frame::Camera, frame::Belt>& T_camera_belt)
    : impl_(std::make_unique<Impl>()) {
  impl_->device = rtcNewDevice("threads=2");
  if (impl_->device == nullptr) throw std::runtime_error("Embree does not start");
  impl_->parts.assign(parts.begin(), parts.end());
  for (const ScenePart& part : parts) impl_->part_scenes.push_back(make_part_scene(impl_->device, part.mesh));
  impl_->T_belt_camera = T_camera_belt.inverse();
  impl_->belt_normal = T_camera_belt.rotation.col(2).cast<float>();
  impl_->belt_offset = static_cast<float>(T_camera_belt.rotation.col(2).dot(T_camera_belt.translation_mm));
  place({});
}

RayScene::~RayScene() {
  rtcReleaseScene(impl_->scene);
  for (RTCScene scene : impl_->part_scenes) rtcReleaseScene(scene);
  rtcReleaseDevice(impl_->device);
}

void RayScene::place(std::span<const PartInstance> instances) {
  if (impl_->scene != nullptr) rtcReleaseScene(impl_->scene);
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  impl_->instances.assign(instances.begin(), instances.end());
  impl_->T_part_camera.clear();
  for (unsigned i = 0; i < instances.size(); ++i) {
    RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, impl_->part_scenes.at(instances[i].part));
    const Eigen::Matrix4f transform = instances[i].T_camera_part.matrix().cast<float>();
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, transform.data());
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(impl_->scene, geometry, i);
    rtcReleaseGeometry(geometry);
    impl_->T_part_camera.push_back(instances[i].T_camera_part.inverse());
  }
  rtcCommitScene(impl_->scene);
}

const std::vector<PartInstance>& RayScene::instances() const { return impl_->instances; }

const ScenePart& RayScene::part(int index) const { return impl_->parts[index]; }

RayHit RayScene::cast(const Vec3f& origin_mm, const Vec3f& direction) const {
  RTCRayHit query{};
  query.ray = make_ray(origin_mm, direction, 0.0F, std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect(impl_->scene, query);
  RayHit hit;
  const float belt = impl_->to_belt(origin_mm, direction);
  const bool on_part = query.hit.geomID != RTC_INVALID_GEOMETRY_ID && (belt <= 0.0F || query.ray.tfar <= belt);
  if (!on_part && belt <= 0.0F) return hit;
  hit.distance = on_part ? query.ray.tfar : belt;
  const Vec3 point = (origin_mm + hit.distance * direction).cast<double>();
  if (!on_part) {
    hit.instance = kHitBelt;
    hit.normal = hit.face_normal = impl_->belt_normal;
    hit.local_mm = (impl_->T_belt_camera * point).cast<float>();
    return hit;
  }
  hit.instance = static_cast<int>(query.hit.instID[0]);
  const PartInstance& instance = impl_->instances[hit.instance];
  const Vec3f face(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
  hit.face_normal = (instance.T_camera_part.rotation.cast<float>() * face).normalized();
  hit.normal = impl_->smooth_normal(query.hit, instance);
  hit.local_mm = (impl_->T_part_camera[hit.instance] * point).cast<float>();
  return hit;
}

bool RayScene::blocked(const Vec3f& origin_mm, const Vec3f& direction) const {
  RTCRay ray = make_ray(origin_mm, direction, 0.0F, 1.0F);
  return occluded(impl_->scene, ray);
}

bool RayScene::meets(int instance, const Vec3f& direction_from_camera, float& distance) const {
  const PartInstance& placed = impl_->instances[instance];
  const auto& to_part = impl_->T_part_camera[instance];
  RTCRayHit query{};
  query.ray = make_ray(to_part.translation_mm.cast<float>(), to_part.rotation.cast<float>() * direction_from_camera,
                       0.0F, std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  intersect(impl_->part_scenes[placed.part], query);
  distance = query.ray.tfar;
  return query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

}  // namespace beltpick::virtual_cell
