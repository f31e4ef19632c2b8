// Trajectories in 3-D: the truth, the estimates up to the shown instant, and the covariance of the
// position as an ellipsoid of three sigmas. z is up, as in G. Drawn only when something changes.

import {
  AmbientLight, BufferGeometry, Color, DirectionalLight, DoubleSide, Float32BufferAttribute, Group,
  LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial,
  PerspectiveCamera, Quaternion, Scene, SphereGeometry, Vector3, WebGLRenderer,
} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import {Line2} from 'three/examples/jsm/lines/Line2.js';
import {LineGeometry} from 'three/examples/jsm/lines/LineGeometry.js';
import {LineMaterial} from 'three/examples/jsm/lines/LineMaterial.js';
import {CSS2DObject, CSS2DRenderer} from 'three/examples/jsm/renderers/CSS2DRenderer.js';
import {covarianceFactor, curvesOf, indexAt} from './data.js';
import {element, significant} from './dom.js';
import {boundsOf, truthsOf} from './layout.js';
import {pageColor, slotColor} from './plots.js';
import {rotate} from './rotation.js';

const kSigmas = 3;
const kAlongTheWay = 14;  // ellipsoids

/** Null where the browser has no WebGL: asked first, because three tells the console otherwise. */
export function openWebGl(canvas) {
  try {
    return canvas.getContext('webgl2', {antialias: true, alpha: true});
  } catch {
    return null;
  }
}

export class Trajectories {
  constructor(host, store, context, canvas, names) {
    this.host = host;
    this.store = store;
    this.names = names;
    this.magnification = 1;
    this.along = true;
    this.renderer = new WebGLRenderer({canvas, context, antialias: true, alpha: true});
    this.labels = new CSS2DRenderer();
    this.labels.domElement.className = 'labels-3d';
    this.labels.domElement.setAttribute('aria-hidden', 'true');
    this.tip = element('div', {class: 'tip', hidden: true});
    host.append(canvas, this.labels.domElement, this.tip);
    this.canvas = canvas;

    this.scene = new Scene();
    this.scene.add(new AmbientLight(0xffffff, 1.6));
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(1, -2, 3);
    this.scene.add(sun);
    this.camera = new PerspectiveCamera(35, 1, 0.01, 1000);
    this.camera.up.set(0, 0, 1);
    // The wheel scrolls the page until the view is chosen: it would be a trap otherwise.
    canvas.addEventListener('wheel', (event) => {
      this.controls.enableZoom = event.ctrlKey || document.activeElement === canvas;
    });
    canvas.addEventListener('pointerdown', () => canvas.focus({preventScroll: true}));
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.draw());
    this.content = new Group();
    this.scene.add(this.content);
    this.sphere = new SphereGeometry(1, 32, 20);

    canvas.addEventListener('keydown', (event) => this.key(event));
    canvas.addEventListener('pointermove', (event) => this.hover(event));
    canvas.addEventListener('pointerleave', () => this.leave());
    new ResizeObserver(() => this.resize()).observe(host);
    store.on('choice', () => this.rebuild());
    store.on('theme', () => this.rebuild());
    store.on('time', () => this.update());
  }

  rebuild() {
    this.clear();
    this.resolution = [this.host.clientWidth || 600, this.host.clientHeight || 400];
    const bounds = boundsOf(this.store);
    const changed = !this.bounds || bounds.key !== this.bounds.key;
    this.bounds = bounds;
    this.addGrid();
    for (const curves of truthsOf(this.store)) {
      this.content.add(this.line(curves.truth, pageColor('--text'), 1.6, [5, 3], 0.9));
    }
    this.moving = this.store.chosen.map((chosen) => this.addRun(chosen));
    if (changed) this.view('corner');
    this.update();
  }

  clear() {
    this.content.traverse((object) => {
      if (object.isCSS2DObject) object.element.remove();
      if (object.geometry && object.geometry !== this.sphere) object.geometry.dispose();
      object.material?.dispose();
    });
    this.content.clear();
  }

  /** Dashes are given in pixels at the view from the corner. */
  line(points, color, width, dash, opacity) {
    const flat = [];
    for (let i = 0; i < points[0].length; ++i) {
      if (points.every((column) => Number.isFinite(column[i]))) {
        flat.push(points[0][i], points[1][i], points[2][i]);
      }
    }
    if (flat.length < 6) return new Group();
    const unit = this.bounds.radius / 260;
    const material = new LineMaterial({
      color: new Color(color),
      linewidth: width,
      transparent: opacity < 1,
      opacity,
      dashed: dash.length > 0,
      dashSize: (dash[0] ?? 1) * unit,
      gapSize: (dash[1] ?? 0) * unit,
    });
    material.resolution.set(...this.resolution);
    const line = new Line2(new LineGeometry().setPositions(flat), material);
    line.computeLineDistances();
    return line;
  }

  addGrid() {
    const {low, high, floor, step} = this.bounds;
    const points = [];
    const color = new Color(pageColor('--grid-3d'));
    for (let x = low[0]; x <= high[0] + 1e-9; x += step) {
      points.push(x, low[1], floor, x, high[1], floor);
    }
    for (let y = low[1]; y <= high[1] + 1e-9; y += step) {
      points.push(low[0], y, floor, high[0], y, floor);
    }
    const top = Math.max(high[2], floor + step);
    points.push(low[0], high[1], floor, low[0], high[1], top);
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new Float32BufferAttribute(points, 3));
    this.content.add(new LineSegments(geometry, new LineBasicMaterial({color})));

    const name = (value) => String(+value.toFixed(6));
    const ticks = (from, to) => {
      const every = Math.round((to - from) / step) > 6 ? 2 : 1;
      const first = Math.ceil(Math.round(from / step) / every) * every;
      const count = Math.floor((Math.round(to / step) - first) / every) + 1;
      return Array.from({length: count}, (_, i) => (first + i * every) * step);
    };
    for (const x of ticks(low[0], high[0])) this.label(name(x), x, low[1] - 0.35 * step, floor);
    for (const y of ticks(low[1], high[1])) this.label(name(y), high[0] + 0.35 * step, y, floor);
    for (const z of ticks(floor, top)) this.label(name(z), low[0], high[1] + 0.25 * step, z);
    this.label('x [m]', (low[0] + high[0]) / 2, low[1] - 1.0 * step, floor, 'axis-name');
    this.label('y [m]', high[0] + 1.25 * step, (low[1] + high[1]) / 2, floor, 'axis-name');
    this.label('z [m]', low[0], high[1] + 0.25 * step, top + 0.5 * step, 'axis-name');
  }

  label(text, x, y, z, name = '') {
    const object = new CSS2DObject(element('span', {class: `label-3d ${name}`}, text));
    object.position.set(x, y, z);
    this.content.add(object);
  }

  ellipsoid(color, opacity) {
    const material = new MeshLambertMaterial({
      color: new Color(color), transparent: true, opacity, depthWrite: false, side: DoubleSide,
    });
    const mesh = new Mesh(this.sphere, material);
    mesh.matrixAutoUpdate = false;
    return mesh;
  }

  addRun({run, slot}) {
    const curves = curvesOf(run, this.store.alignment);
    const color = slotColor(slot);
    const whole = this.line(curves.estimate, color, 1.4, slot.dash, 0.3);
    const trail = this.line(curves.estimate, color, 2.6, slot.dash, 1);
    const marker = new Mesh(this.sphere, new MeshBasicMaterial({color: new Color(color)}));
    marker.scale.setScalar(this.bounds.radius * 0.012);
    const truth = new Mesh(this.sphere, new MeshBasicMaterial({color: new Color(pageColor('--text'))}));
    truth.scale.setScalar(this.bounds.radius * 0.009);
    truth.visible = curves.has_truth;
    const body = this.bodyAxes();
    const now = this.ellipsoid(color, 0.35);
    const along = [];
    for (let k = 0; this.along && k < kAlongTheWay; ++k) {
      along.push(this.ellipsoid(color, 0.14));
    }
    this.content.add(whole, trail, marker, truth, body, now, ...along);
    return {run, curves, trail, marker, truth, body, now, along, segments: trail.geometry?.instanceCount};
  }

  /** The body's axes: x longest, so that they are told apart without colours. */
  bodyAxes() {
    const lengths = [1.6, 1.0, 0.6];
    const colors = ['#d55e00', '#009e73', '#0072b2'];
    const positions = [];
    const tints = [];
    lengths.forEach((length, k) => {
      const end = [0, 0, 0];
      end[k] = length;
      const c = new Color(colors[k]);
      positions.push(0, 0, 0, ...end);
      tints.push(c.r, c.g, c.b, c.r, c.g, c.b);
    });
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new Float32BufferAttribute(positions, 3));
    geometry.setAttribute('color', new Float32BufferAttribute(tints, 3));
    const axes = new LineSegments(geometry, new LineBasicMaterial({vertexColors: true}));
    axes.scale.setScalar(this.bounds.radius * 0.07);
    return axes;
  }

  placeEllipsoid(mesh, curves, i) {
    const L = covarianceFactor(curves.covariance, i);
    mesh.visible = L !== null;
    if (!L) return;
    const s = kSigmas * this.magnification;
    const column = (k) => rotate(curves.rotation, [L[k], L[3 + k], L[6 + k]]).map((v) => s * v);
    const [x, y, z] = [column(0), column(1), column(2)];
    const [px, py, pz] = curves.estimate.map((values) => values[i]);
    mesh.matrix.copy(new Matrix4().set(x[0], y[0], z[0], px,
                                       x[1], y[1], z[1], py,
                                       x[2], y[2], z[2], pz,
                                       0, 0, 0, 1));
    mesh.matrixWorldNeedsUpdate = true;
  }

  update() {
    for (const entry of this.moving ?? []) {
      const {curves} = entry;
      const i = indexAt(curves.t, this.store.shownTime);
      const at = (columns) => new Vector3(columns[0][i], columns[1][i], columns[2][i]);
      entry.marker.position.copy(at(curves.estimate));
      entry.body.position.copy(entry.marker.position);
      entry.body.quaternion.copy(new Quaternion(...curves.attitude[i]));
      if (curves.has_truth) entry.truth.position.copy(at(curves.truth));
      if (entry.segments) entry.trail.geometry.instanceCount = Math.max(0, Math.min(i, entry.segments));
      entry.trail.visible = i > 0;
      this.placeEllipsoid(entry.now, curves, i);
      entry.along.forEach((mesh, k) => {
        const time = curves.t[0] + ((k + 0.5) / kAlongTheWay) * (curves.t.at(-1) - curves.t[0]);
        if (time > this.store.shownTime) {
          mesh.visible = false;
        } else {
          this.placeEllipsoid(mesh, curves, indexAt(curves.t, time));
        }
      });
    }
    this.draw();
  }

  /** 'corner', 'top' or 'side': from there, as near as all of it is seen. */
  view(name) {
    const direction = {corner: [0.5, -0.85, 0.5], top: [0, -1e-4, 1], side: [0, -1, 0.02]}[name];
    const {low, high, floor, step, radius} = this.bounds;
    const corners = [];
    for (const x of [low[0] - 0.8 * step, high[0] + 1.4 * step]) {
      for (const y of [low[1] - 1.4 * step, high[1] + 0.3 * step]) {
        for (const z of [floor, high[2] + 0.3 * step]) corners.push(new Vector3(x, y, z));
      }
    }
    const center = corners.reduce((sum, c) => sum.add(c), new Vector3()).divideScalar(corners.length);
    const away = new Vector3(...direction).normalize();
    let distance = 4 * radius;
    for (let round = 0; round < 6; ++round) {
      this.camera.near = distance / 1000;
      this.camera.far = distance * 100;
      this.camera.updateProjectionMatrix();
      this.controls.target.copy(center);
      this.camera.position.copy(center).addScaledVector(away, distance);
      this.controls.update();
      this.camera.updateMatrixWorld();
      const reach = {low: [Infinity, Infinity], high: [-Infinity, -Infinity]};
      for (const corner of corners) {
        const {x, y} = corner.clone().project(this.camera);
        reach.low = [Math.min(reach.low[0], x), Math.min(reach.low[1], y)];
        reach.high = [Math.max(reach.high[0], x), Math.max(reach.high[1], y)];
      }
      const half = [0, 1].map((k) => (reach.high[k] - reach.low[k]) / 2);
      const middle = [0, 1].map((k) => (reach.high[k] + reach.low[k]) / 2);
      const unit = distance * Math.tan((this.camera.fov * Math.PI) / 360);
      const right = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
      const up = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
      center.addScaledVector(right, middle[0] * unit * this.camera.aspect).addScaledVector(up, middle[1] * unit);
      distance *= Math.max(...half) / 0.95;
    }
    this.draw();
  }

  key(event) {
    const turn = (right, up) => {
      const offset = this.camera.position.clone().sub(this.controls.target);
      offset.applyAxisAngle(new Vector3(0, 0, 1), right);
      const axis = new Vector3().crossVectors(offset, new Vector3(0, 0, 1)).normalize();
      const tipped = offset.clone().applyAxisAngle(axis, up);
      const polar = tipped.angleTo(new Vector3(0, 0, 1));
      if (polar > 0.02 && polar < Math.PI - 0.02) offset.copy(tipped);
      this.camera.position.copy(this.controls.target).add(offset);
    };
    const zoom = (factor) => {
      this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    };
    const move = (right, up) => {
      const distance = this.camera.position.distanceTo(this.controls.target) * 0.05;
      const shift = new Vector3().setFromMatrixColumn(this.camera.matrix, 0).multiplyScalar(right * distance)
                        .add(new Vector3().setFromMatrixColumn(this.camera.matrix, 1).multiplyScalar(up * distance));
      this.camera.position.add(shift);
      this.controls.target.add(shift);
    };
    const step = event.shiftKey ? move : (right, up) => turn(right * 0.09, up * 0.09);
    const actions = {
      ArrowLeft: () => step(-1, 0),
      ArrowRight: () => step(1, 0),
      ArrowUp: () => step(0, 1),
      ArrowDown: () => step(0, -1),
      '+': () => zoom(0.9),
      '=': () => zoom(0.9),
      '-': () => zoom(1 / 0.9),
      0: () => this.view('corner'),
    };
    const action = event.ctrlKey || event.altKey || event.metaKey ? null : actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
    this.controls.update();
    this.draw();
  }

  /** Says what is known of the estimate nearest to the pointer, and shows its instant. */
  hover(event) {
    if (event.buttons !== 0) return;
    const box = this.canvas.getBoundingClientRect();
    const x = event.clientX - box.left;
    const y = event.clientY - box.top;
    const point = new Vector3();
    let best = {distance: 12};
    for (const entry of this.moving ?? []) {
      const [px, py, pz] = entry.curves.estimate;
      for (let i = 0; i < px.length; ++i) {
        point.set(px[i], py[i], pz[i]).project(this.camera);
        if (point.z > 1) continue;
        const distance = Math.hypot(((point.x + 1) / 2) * box.width - x, ((1 - point.y) / 2) * box.height - y);
        if (distance < best.distance) best = {distance, entry, i};
      }
    }
    if (!best.entry) return this.leave();
    const {run, curves} = best.entry;
    const i = best.i;
    this.hovering = true;
    this.store.setPeek(curves.t[i]);
    const lines = [
      this.names(run),
      `t = ${curves.t[i].toFixed(2)} s`,
      `x, y, z = ${curves.estimate.map((c) => c[i].toFixed(3)).join(', ')} m`,
    ];
    if (Number.isFinite(curves.position.norm[i])) {
      lines.push(`error ${significant(curves.position.norm[i])} m, ` +
                 `${significant(curves.orientation.norm[i])} deg`);
    }
    this.tip.replaceChildren(...lines.map((line) => element('div', {}, line)));
    this.tip.hidden = false;
    const left = Math.min(x + 14, box.width - this.tip.offsetWidth - 4);
    const top = Math.min(y + 14, box.height - this.tip.offsetHeight - 4);
    this.tip.style.transform = `translate(${Math.max(0, left)}px, ${Math.max(0, top)}px)`;
    return undefined;
  }

  leave() {
    this.tip.hidden = true;
    if (this.hovering) this.store.setPeek(null);
    this.hovering = false;
  }

  resize() {
    const [width, height] = [this.host.clientWidth, this.host.clientHeight];
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.labels.setSize(width, height);
    const first = this.camera.aspect === 1 && this.bounds;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.content.traverse((object) => object.material?.resolution?.set(width, height));
    if (first) this.view('corner');
    this.draw();
  }

  draw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.renderer.render(this.scene, this.camera);
      this.labels.render(this.scene, this.camera);
    });
  }
}
