// SPDX-License-Identifier: Apache-2.0
// The C interface from C#: two tetrahedra, pulled until one breaks.
using System;
using System.Runtime.InteropServices;

[StructLayout(LayoutKind.Sequential)]
struct Selection {
  public int kind, reserved;
  public IntPtr ids;
  public UIntPtr idCount;
  [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] min, max;
  public double radius;
}

[StructLayout(LayoutKind.Sequential)]
struct Material {
  public uint structSize, reserved;
  public double young, poisson, yield;
  public string name;
}

[StructLayout(LayoutKind.Sequential)]
struct Support {
  public uint structSize, axes;
  public Selection nodes;
}

[StructLayout(LayoutKind.Sequential)]
struct Instrument {
  public uint structSize;
  public int kind;
  public string name;
  public Selection nodes;
  [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] value;
  public uint axes;
  public int side, crack, hasRamp;
  [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] at;
  [MarshalAs(UnmanagedType.ByValArray, SizeConst = 2)] public double[] ramp;
}

[StructLayout(LayoutKind.Sequential)]
struct Fracture {
  public uint structSize;
  public int model;
  public double alpha;
  public int yieldMeasure, sigma0, crackLength, birth, sif, maxEvents, hasPlaneNormal, attribution;
  [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] planeNormal;
}

static class Native {
  const string Library = "sunder";
  [DllImport(Library)] public static extern IntPtr sunder_last_error();
  [DllImport(Library)] public static extern int sunder_scene_create(out IntPtr scene);
  [DllImport(Library)] public static extern int sunder_scene_destroy(IntPtr scene);
  [DllImport(Library)]
  public static extern int sunder_scene_set_mesh(IntPtr scene, double[] nodes, UIntPtr nodesSize,
                                                 int[] tets, UIntPtr tetsSize, int[] materialOf,
                                                 UIntPtr materialOfSize);
  [DllImport(Library)]
  public static extern int sunder_scene_add_material(IntPtr scene, ref Material m, IntPtr index);
  [DllImport(Library)]
  public static extern int sunder_scene_add_support(IntPtr scene, ref Support s);
  [DllImport(Library)]
  public static extern int sunder_scene_add_instrument(IntPtr scene, ref Instrument i,
                                                       IntPtr index);
  [DllImport(Library)] public static extern void sunder_fracture_options_init(ref Fracture f);
  [DllImport(Library)]
  public static extern int sunder_scene_set_fracture(IntPtr scene, ref Fracture f);
  [DllImport(Library)]
  public static extern int sunder_simulation_create(IntPtr scene, IntPtr callbacks,
                                                    out IntPtr simulation);
  [DllImport(Library)]
  public static extern int sunder_simulation_step(IntPtr simulation, IntPtr step);
  [DllImport(Library)]
  public static extern int sunder_simulation_destroyed(IntPtr simulation, byte[] values,
                                                       UIntPtr size);
  [DllImport(Library)] public static extern int sunder_simulation_destroy(IntPtr simulation);
}

static class Board {
  static void Check(int status) {
    if (status != 0) throw new Exception(Marshal.PtrToStringAnsi(Native.sunder_last_error()));
  }

  static Selection Ids(params int[] numbers) {
    IntPtr copy = Marshal.AllocHGlobal(4 * numbers.Length);
    Marshal.Copy(numbers, 0, copy, numbers.Length);
    return new Selection { ids = copy, idCount = (UIntPtr)numbers.Length, min = new double[3],
                           max = new double[3] };
  }

  static int Main() {
    double[] nodes = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1 };
    int[] tets = { 0, 1, 2, 3, 1, 4, 2, 3 };
    IntPtr scene, simulation;
    Check(Native.sunder_scene_create(out scene));
    Check(Native.sunder_scene_set_mesh(scene, nodes, (UIntPtr)15, tets, (UIntPtr)8, null,
                                       UIntPtr.Zero));
    var tissue = new Material { structSize = (uint)Marshal.SizeOf(typeof(Material)), young = 5,
                                poisson = 0.4, yield = 2 };
    Check(Native.sunder_scene_add_material(scene, ref tissue, IntPtr.Zero));
    var support = new Support { structSize = (uint)Marshal.SizeOf(typeof(Support)), axes = 7,
                                nodes = Ids(0, 2, 3) };
    Check(Native.sunder_scene_add_support(scene, ref support));
    var forceps = new Instrument { structSize = (uint)Marshal.SizeOf(typeof(Instrument)),
                                   nodes = Ids(4), value = new double[] { 40, 0, 0 }, axes = 7,
                                   at = new double[3], ramp = new double[2] };
    Check(Native.sunder_scene_add_instrument(scene, ref forceps, IntPtr.Zero));
    var fracture = new Fracture { planeNormal = new double[3] };
    Native.sunder_fracture_options_init(ref fracture);
    if (fracture.structSize != Marshal.SizeOf(typeof(Fracture))) throw new Exception("layout");
    fracture.model = 1;
    Check(Native.sunder_scene_set_fracture(scene, ref fracture));
    Check(Native.sunder_simulation_create(scene, IntPtr.Zero, out simulation));
    Check(Native.sunder_simulation_step(simulation, IntPtr.Zero));
    var destroyed = new byte[2];
    Check(Native.sunder_simulation_destroyed(simulation, destroyed, (UIntPtr)2));
    int count = destroyed[0] + destroyed[1];
    // A wrong call is a status, not the end of the process.
    if (Native.sunder_simulation_step(scene, IntPtr.Zero) != 7) throw new Exception("no status");
    Check(Native.sunder_simulation_destroy(simulation));
    Check(Native.sunder_scene_destroy(scene));
    Console.WriteLine("c#: " + count + " destroyed");
    return count > 0 ? 0 : 1;
  }
}
