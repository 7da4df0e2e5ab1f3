//! The few functions of Embree 4 that the comparison calls, by its C interface.

use etendue_core::{geometry::Mesh, ray::Ray};
use libloading::Library;
use std::{
    ffi::{c_char, c_int, c_uint, c_void},
    ptr::null_mut,
};

/// Embree's `RTCRayHit`, with room behind it for fields that builds with more instance levels add.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
struct RayHit {
    origin: [f32; 3],
    t_near: f32,
    direction: [f32; 3],
    time: f32,
    t_far: f32,
    mask: c_uint,
    id: c_uint,
    flags: c_uint,
    normal: [f32; 3],
    u: f32,
    v: f32,
    primitive: c_uint,
    geometry: c_uint,
    rest: [c_uint; 9],
}

impl RayHit {
    fn new(ray: &Ray) -> RayHit {
        RayHit {
            origin: ray.origin.to_array(),
            t_near: 0.0,
            direction: ray.direction.to_array(),
            time: 0.0,
            t_far: ray.t_max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            primitive: u32::MAX,
            geometry: u32::MAX,
            rest: [u32::MAX; 9],
        }
    }
}

type NewDevice = unsafe extern "C" fn(*const c_char) -> *mut c_void;
type OfHandle = unsafe extern "C" fn(*mut c_void);
type NewScene = unsafe extern "C" fn(*mut c_void) -> *mut c_void;
type Set = unsafe extern "C" fn(*mut c_void, c_int);
type NewGeometry = unsafe extern "C" fn(*mut c_void, c_int) -> *mut c_void;
type SetBuffer = unsafe extern "C" fn(*mut c_void, c_int, c_uint, c_int, *const c_void, usize, usize, usize);
type Attach = unsafe extern "C" fn(*mut c_void, *mut c_void) -> c_uint;
type Query = unsafe extern "C" fn(*mut c_void, *mut RayHit, *mut c_void);

const TRIANGLES: c_int = 0;
const INDEX_BUFFER: c_int = 0;
const VERTEX_BUFFER: c_int = 1;
const UINT3: c_int = 0x5003;
const FLOAT3: c_int = 0x9003;
const HIGH_QUALITY: c_int = 2;
const ROBUST: c_int = 1 << 2;

/// Embree, loaded.
pub struct Embree {
    library: Library,
    device: *mut c_void,
}

impl Embree {
    /// Loads the library at `path` with as many threads for building as `threads` says.
    pub fn load(path: &std::ffi::OsStr, threads: usize) -> Result<Embree, libloading::Error> {
        // SAFETY: whoever sets the variable vouches that the file is Embree 4, whose initialisers are sound.
        let library = unsafe { Library::new(path) }?;
        let configuration = format!("threads={threads}\0");
        // SAFETY: the signature is that of embree4/rtcore_device.h; the string ends with a zero.
        let device = unsafe { library.get::<NewDevice>(b"rtcNewDevice")?(configuration.as_ptr().cast()) };
        assert!(!device.is_null(), "Embree gives no device");
        Ok(Embree { library, device })
    }

    fn get<T: Copy>(&self, name: &str) -> T {
        // SAFETY: every caller names a function of Embree 4 with the type that its headers declare.
        *unsafe { self.library.get::<T>(name.as_bytes()) }.unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Builds a scene of high quality; `robust` asks for the slower, safer tests.
    pub fn scene<'a>(&'a self, mesh: &'a Mesh, robust: bool) -> EmbreeScene<'a> {
        // Embree reads 16 bytes at the last vertex.
        let mut positions: Vec<f32> = mesh.positions.iter().flat_map(|p| p.to_array()).collect();
        positions.push(0.0);
        let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
        // SAFETY: the types are those of the headers; both buffers live as long as the scene, which keeps or borrows them.
        let scene = unsafe {
            let scene = self.get::<NewScene>("rtcNewScene")(self.device);
            self.get::<Set>("rtcSetSceneBuildQuality")(scene, HIGH_QUALITY);
            self.get::<Set>("rtcSetSceneFlags")(scene, if robust { ROBUST } else { 0 });
            let geometry = self.get::<NewGeometry>("rtcNewGeometry")(self.device, TRIANGLES);
            let set: SetBuffer = self.get("rtcSetSharedGeometryBuffer");
            set(geometry, VERTEX_BUFFER, 0, FLOAT3, positions.as_ptr().cast(), 0, 12, vertices);
            set(geometry, INDEX_BUFFER, 0, UINT3, mesh.triangles.as_ptr().cast(), 0, 12, triangles);
            self.get::<OfHandle>("rtcCommitGeometry")(geometry);
            self.get::<Attach>("rtcAttachGeometry")(scene, geometry);
            self.get::<OfHandle>("rtcReleaseGeometry")(geometry);
            self.get::<OfHandle>("rtcCommitScene")(scene);
            scene
        };
        let (intersect, occluded) = (self.get("rtcIntersect1"), self.get("rtcOccluded1"));
        EmbreeScene { embree: self, scene, intersect, occluded, _positions: positions }
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: the device came from rtcNewDevice and no scene of it is left, as they borrow it.
        unsafe { self.get::<OfHandle>("rtcReleaseDevice")(self.device) };
    }
}

/// A scene in Embree.
pub struct EmbreeScene<'a> {
    embree: &'a Embree,
    scene: *mut c_void,
    intersect: Query,
    occluded: Query,
    _positions: Vec<f32>,
}

impl EmbreeScene<'_> {
    /// Distance of the nearest hit.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<f32> {
        let mut query = RayHit::new(ray);
        // SAFETY: the scene is committed; the structure is at least as large and aligned as Embree wants.
        unsafe { (self.intersect)(self.scene, &raw mut query, null_mut()) };
        (query.geometry != u32::MAX).then_some(query.t_far)
    }

    /// Whether anything is hit.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        let mut query = RayHit::new(ray);
        // SAFETY: as above; RTCRay is the beginning of RTCRayHit.
        unsafe { (self.occluded)(self.scene, &raw mut query, null_mut()) };
        query.t_far < 0.0
    }
}

impl Drop for EmbreeScene<'_> {
    fn drop(&mut self) {
        // SAFETY: the scene came from rtcNewScene and is released once.
        unsafe { self.embree.get::<OfHandle>("rtcReleaseScene")(self.scene) };
    }
}
