// Light, ground, camera, and drawing when something changed.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const DIRECTIONS = { oblique: [1, -1.25, 0.75], front: [1, 0, 0.12], side: [0, -1, 0.12], top: [0.001, 0, 1] };

export class Scene {
  constructor(canvas, robot) {
    this.canvas = canvas;
    this.robots = [robot];
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.shadowMap.enabled = true;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(42, 1, 0.01, 1000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.redraw());
    this.overlays = new THREE.Group();
    this.scene.add(robot.root, this.overlays, new THREE.HemisphereLight(0xffffff, 0x9a9080, 1.6));
    this.sun = new THREE.DirectionalLight(0xffffff, 2.2);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    this.scene.add(this.sun, this.sun.target);
    this.follow = false;
    this.dirty = true;
    this.drawn = 0;
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }

  add(robot, place) {
    this.robots.push(robot);
    this.scene.add(place);
  }
  box() {
    return this.robots.reduce((box, robot) => box.union(robot.box()), new THREE.Box3());
  }

  // The size of what is shown decides the light, the grid and the near plane: once, when the first pose is known.
  settle() {
    const box = this.box();
    this.size = Math.max(box.getSize(new THREE.Vector3()).length(), 0.05);
    const s = this.size;
    Object.assign(
      this.sun.shadow.camera, { left: -2 * s, right: 2 * s, top: 2 * s, bottom: -2 * s, near: 0.01 * s, far: 10 * s });
    this.sun.shadow.camera.updateProjectionMatrix();
    this.camera.near = s / 200;
    this.camera.far = s * 400;
    this.#ground(s);
    this.look("oblique");
  }

  #ground(s) {
    const cell = 10 ** Math.round(Math.log10(s / 4));
    const lines = window.matchMedia("(prefers-color-scheme: dark)").matches ? [0x4a5563, 0x343d49] : [0x9aa3ae, 0xc8ced6];
    this.grid = new THREE.GridHelper(cell * 100, 100, ...lines).rotateX(Math.PI / 2);
    this.grid.material.transparent = true;
    this.grid.material.opacity = 0.7;
    const shade = new THREE.Mesh(new THREE.PlaneGeometry(cell * 100, cell * 100), new THREE.ShadowMaterial({ opacity: 0.18 }));
    shade.receiveShadow = true;
    shade.position.z = -s / 1000;
    this.scene.add(this.grid, shade);
  }

  look(preset) {
    this.#see(new THREE.Vector3(...DIRECTIONS[preset]), this.robots.length > 1 ? undefined : this.size);
  }
  // All of the robot, from where the camera is.
  fit() {
    this.#see(this.camera.position.clone().sub(this.controls.target));
  }
  #see(from, across) {
    const box = this.box(), centre = box.getCenter(new THREE.Vector3());
    across ??= Math.max(box.getSize(new THREE.Vector3()).length(), 0.05);
    const distance = (0.62 * across) / Math.tan((this.camera.fov * Math.PI) / 360);
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(from.normalize(), distance);
    this.controls.update();
    this.redraw();
  }

  // Light, and with `follow` the camera, go with the robot.
  track(point) {
    if (this.follow && this.last) {
      const step = point.clone().sub(this.last);
      this.camera.position.add(step);
      this.controls.target.add(step);
      this.controls.update();
    }
    this.last = point.clone();
    this.sun.target.position.copy(point);
    this.sun.position.copy(point).add(new THREE.Vector3(0.8, -1.2, 2.4).multiplyScalar(this.size));
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.redraw();
  }

  redraw() {
    this.dirty = true;
  }
  draw() {
    if (!this.dirty) return;
    this.dirty = false;
    this.renderer.render(this.scene, this.camera);
    ++this.drawn;
  }
}
