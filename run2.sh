. /tmp/hN/env.sh; cd /tmp/hN/r
cat > s.py <<'P'
import sys; sys.path.insert(0,"/work/hN/tests")
import slotted, math
import presswear as pw
for name, link, joints in (("quick", slotted.quick_return(), "A"), ("yoke", slotted.scotch_yoke(), "A"), ("shaper", slotted.shaper(), "A, B")):
    scene = pw.Scene(link, joints=joints, bearings=pw.Bearing(clearance="0.2 mm"), cycles=7, wear_updates=1, drive_torque="on", engine="dae")
    print(pw.run(scene, name)); 
    from presswear.show.report import write_report
    write_report(pw.load(name))
cyl = pw.assemble(bodies=[pw.Body("slide", mass="300 kg")], joints=[pw.Guide("guide","slide",direction="90 deg")],
  drives=[pw.LinearDrive("slide", along="guide", position="200 mm", frequency="30 spm", rises=[pw.Rise(0.5,2.5,-0.2), pw.Rise(3.5,5.5,0.2)])], output="slide")
write_report(pw.run(pw.Scene(cyl, joints="none", cycles=2, drive_torque="on"), "cyl"))
c = slotted.cylinder()
write_report(pw.run(pw.Scene(c, joints="A, B", bearings=pw.Bearing(clearance="0.2 mm"), cycles=5, wear_updates=0, drive_torque="on", engine="dae"), "cylrod"))
P
time /opt/pw/bin/python s.py
