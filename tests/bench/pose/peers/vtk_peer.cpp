#include "bench/pose/peers/vtk_peer.hpp"

#include <vtkCellArray.h>
#include <vtkIterativeClosestPointTransform.h>
#include <vtkLandmarkTransform.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

namespace beltpick::bench {
namespace {

constexpr int kIterations = 200;

// Points as VTK's closest-cell search wants them: each a vertex cell.
class PointCloud {
 public:
  void add(const Vec3& at) {
    const vtkIdType id = points_->InsertNextPoint(at.x(), at.y(), at.z());
    cells_->InsertNextCell(1, &id);
  }
  vtkPolyData* data() {
    data_->SetPoints(points_);
    data_->SetVerts(cells_);
    return data_;
  }

 private:
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> cells_;
  vtkNew<vtkPolyData> data_;
};

}  // namespace

PeerFit vtk_icp(const PeerObject& object) {
  const Pose<frame::Part, frame::Camera> start = object.starts.front().inverse();
  PointCloud source, target;
  for (const OrientedPoint& point : object.sample) source.add(start * point.point_mm.cast<double>());
  for (const Vec3f& point : object.part->point_mm) target.add(point.cast<double>());
  vtkNew<vtkIterativeClosestPointTransform> icp;
  icp->SetSource(source.data());
  icp->SetTarget(target.data());
  icp->GetLandmarkTransform()->SetModeToRigidBody();
  icp->SetMaximumNumberOfIterations(kIterations);
  icp->SetMaximumNumberOfLandmarks(static_cast<int>(object.sample.size()));
  icp->Update();
  Mat4 moved;
  for (int row = 0; row < 4; ++row) {
    for (int col = 0; col < 4; ++col) moved(row, col) = icp->GetMatrix()->GetElement(row, col);
  }
  const auto T_part_camera = Pose<frame::Part, frame::Part>::from_matrix(moved) * start;
  return {T_part_camera.inverse(), icp->GetMeanDistance()};
}

}  // namespace beltpick::bench
