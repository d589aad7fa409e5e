import './style.css';

import { Driver } from './page/driver';
import { Viewer } from './viewer';

declare global {
  interface Window {
    peerd: Driver;
  }
}

const root = document.getElementById('app');
if (root === null) throw new Error('the page has no element #app');
const viewer = new Viewer(root);
window.peerd = new Driver(viewer);
viewer.start();
