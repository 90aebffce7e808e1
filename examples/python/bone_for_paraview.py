"""A bone coloured by its clearance to an implant, and the part that is proven to lie within a limit: for ParaView.

    python3 bone_for_paraview.py STEM.json BONE.off OUT.vtu [LIMIT]

Needs meshio (Debian: python3-meshio), which reads and writes what it knows: .stl, .ply, .vtk, .vtu, .obj ...
With VTK (python3-vtk9) the proven part is written beside it, as OUT_within.vtp.
"""

import sys
from pathlib import Path

import meshio
import numpy as np
import verisq

stem = verisq.Model.load(sys.argv[1])
bone = meshio.read(sys.argv[2])
out = Path(sys.argv[3])
limit = float(sys.argv[4]) if len(sys.argv) > 4 else 2.0

lo, hi, status = verisq.map(stem, bone.points)
# 1: proven within the limit; 0: proven beyond it; 0.5: undecided, which no picture should hide.
within = np.where(hi <= limit, 1.0, np.where(lo > limit, 0.0, 0.5))
meshio.write(out, meshio.Mesh(bone.points, bone.cells, point_data={"lo": lo, "hi": hi, "within": within}))
print(f"{out.name}: {np.sum(within == 1)} vertices within {limit:g} {stem.units}, {np.sum(within == 0.5)} undecided")

try:
    from vtkmodules.vtkCommonDataModel import vtkDataObject
    from vtkmodules.vtkFiltersCore import vtkThreshold
    from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridReader
except ImportError:
    sys.exit()

reader = vtkXMLUnstructuredGridReader()
reader.SetFileName(str(out))
# Triangles whose three vertices are proven to be near enough. Of the points between them that proves nothing yet:
# verisq.map_triangles does.
threshold = vtkThreshold()
threshold.SetInputConnection(reader.GetOutputPort())
threshold.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "hi")
threshold.SetThresholdFunction(vtkThreshold.THRESHOLD_LOWER)
threshold.SetLowerThreshold(limit)
threshold.AllScalarsOn()
surface = vtkGeometryFilter()
surface.SetInputConnection(threshold.GetOutputPort())
writer = vtkXMLPolyDataWriter()
writer.SetFileName(str(out.with_name(out.stem + "_within.vtp")))
writer.SetInputConnection(surface.GetOutputPort())
writer.Write()
print(f"{out.stem}_within.vtp: {surface.GetOutput().GetNumberOfCells()} triangles")
