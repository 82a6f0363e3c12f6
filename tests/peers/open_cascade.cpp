// Reads STEP files by Open CASCADE and prints a line for each face: kind, area, radii or half angle [deg]. Status 1 where a
// file cannot be read or holds a shape that Open CASCADE finds invalid.

#include <cstdio>

#include <BRepAdaptor_Surface.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>

int main(int count, char** arguments) {
  for (int i = 1; i < count; ++i) {
    STEPControl_Reader reader;
    if (reader.ReadFile(arguments[i]) != IFSelect_RetDone || reader.TransferRoots() != 1) return 1;
    const TopoDS_Shape shape = reader.OneShape();
    if (!BRepCheck_Analyzer(shape).IsValid()) return 1;
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
      const BRepAdaptor_Surface surface(TopoDS::Face(face.Current()));
      GProp_GProps properties;
      BRepGProp::SurfaceProperties(face.Current(), properties);
      const double area = properties.Mass();
      switch (surface.GetType()) {
        case GeomAbs_Plane:
          std::printf("plane %.9g\n", area);
          break;
        case GeomAbs_Sphere:
          std::printf("sphere %.9g %.9g\n", area, surface.Sphere().Radius());
          break;
        case GeomAbs_Cylinder:
          std::printf("cylinder %.9g %.9g\n", area, surface.Cylinder().Radius());
          break;
        case GeomAbs_Cone:
          std::printf("cone %.9g %.9g\n", area, surface.Cone().SemiAngle() * 57.29577951308232);
          break;
        case GeomAbs_Torus:
          std::printf("torus %.9g %.9g %.9g\n", area, surface.Torus().MajorRadius(),
                      surface.Torus().MinorRadius());
          break;
        default:
          std::printf("other %.9g\n", area);
          return 1;
      }
    }
  }
  return 0;
}
