// SPDX-License-Identifier: Apache-2.0
// The C interface from C#: two tetrahedra, pulled until one breaks. Init() is what SUNDER_..._INIT
// does in C: structSize as it is declared here, and the defaults.
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

  public static Material Init() {
    return new Material { structSize = (uint)Marshal.SizeOf(typeof(Material)) };
  }
}

[StructLayout(LayoutKind.Sequential)]
struct Support {
  public uint structSize, axes;
  public Selection nodes;

  public static Support Init() {
    return new Support { structSize = (uint)Marshal.SizeOf(typeof(Support)), axes = 7 };
  }
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

  public static Instrument Init() {
    return new Instrument { structSize = (uint)Marshal.SizeOf(typeof(Instrument)), axes = 7,
                            value = new double[3], at = new double[3], ramp = new double[2] };
  }
}

[StructLayout(LayoutKind.Sequential)]
struct Fracture {
  public uint structSize;
  public int model;
  public double alpha;
  public int yieldMeasure, sigma0, crackLength, birth, sif, maxEvents, hasPlaneNormal, attribution;
  [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] planeNormal;

  public static Fracture Init() {
    return new Fracture { structSize = (uint)Marshal.SizeOf(typeof(Fracture)), alpha = 1e-6,
                          maxEvents = 10000, planeNormal = new double[3] };
  }
}

[StructLayout(LayoutKind.Sequential)]
struct Step {
  public uint structSize;
  public int step;
  public double loadFactor;
  public int events, destroyed, iterations, polished;
  public double compliance, residual, error, maxYieldRatio;
  public double msLoad, msSolve, msStress, msDecide, msUpdate, msTotal;

  public static Step Init() {
    return new Step { structSize = (uint)Marshal.SizeOf(typeof(Step)) };
  }
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
  [DllImport(Library)]
  public static extern int sunder_scene_set_fracture(IntPtr scene, ref Fracture f);
  [DllImport(Library)]
  public static extern int sunder_simulation_create(IntPtr scene, IntPtr callbacks,
                                                    out IntPtr simulation);
  [DllImport(Library)]
  public static extern int sunder_simulation_step(IntPtr simulation, ref Step step);
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
    var tissue = Material.Init();
    tissue.young = 5;
    tissue.poisson = 0.4;
    tissue.yield = 2;
    Check(Native.sunder_scene_add_material(scene, ref tissue, IntPtr.Zero));
    var support = Support.Init();
    support.nodes = Ids(0, 2, 3);
    Check(Native.sunder_scene_add_support(scene, ref support));
    var forceps = Instrument.Init();
    forceps.nodes = Ids(4);
    forceps.value[0] = 40;
    Check(Native.sunder_scene_add_instrument(scene, ref forceps, IntPtr.Zero));
    var fracture = Fracture.Init();
    fracture.model = 1;
    Check(Native.sunder_scene_set_fracture(scene, ref fracture));
    Check(Native.sunder_simulation_create(scene, IntPtr.Zero, out simulation));
    var step = Step.Init();
    Check(Native.sunder_simulation_step(simulation, ref step));
    var destroyed = new byte[2];
    Check(Native.sunder_simulation_destroyed(simulation, destroyed, (UIntPtr)2));
    int count = destroyed[0] + destroyed[1];
    if (step.destroyed != count || step.loadFactor != 1) throw new Exception("layout");
    // A wrong call is a status, not the end of the process.
    if (Native.sunder_simulation_step(scene, ref step) != 7) throw new Exception("no status");
    Check(Native.sunder_simulation_destroy(simulation));
    Check(Native.sunder_scene_destroy(scene));
    Console.WriteLine("c#: " + count + " destroyed");
    return count > 0 ? 0 : 1;
  }
}
