import verisq

stem = verisq.Model.load("examples/stem_mm.json")  # or a closed mesh: verisq.Model.load("implant.stl")
bone = verisq.Mesh.load("examples/cavity.off")
lo, hi, status = verisq.map(stem, bone.vertices)
print(f"{(lo > 1.9).sum()} of {len(lo)} vertices are proven farther than 1.9 mm, {(hi < 1.9).sum()} nearer")
