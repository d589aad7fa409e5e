// What tests ask of pictures and of a page's layout.
import { check } from './real_peers.mjs';

// How many pixels differ between two screenshots, counted by the browser itself on an empty page.
export async function differingPixels(browser, a, b) {
  const tab = await browser.newPage();
  const count = await tab.evaluate(async (pictures) => {
    const [first, second] = await Promise.all(pictures.map(async (data) => {
      const image = new Image();
      image.src = `data:image/png;base64,${data}`;
      await image.decode();
      const canvas = new OffscreenCanvas(image.width, image.height);
      const context = canvas.getContext('2d');
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, image.width, image.height).data;
    }));
    let differing = 0;
    for (let i = 0; i < first.length; i += 4) {
      const off = Math.abs(first[i] - second[i]) + Math.abs(first[i + 1] - second[i + 1]) + Math.abs(first[i + 2] - second[i + 2]);
      if (off > 48) ++differing;
    }
    return differing;
  }, [a.toString('base64'), b.toString('base64')]);
  await tab.close();
  return count;
}

// Nothing is wider than the window, and the picture keeps a place of its own.
export async function looksWhole(page, width) {
  const faults = await page.tab.evaluate(() => {
    const wide = [...document.querySelectorAll('.app, .bar, .timeline, .toolbar, .stage, .dock')].filter((element) => element.getBoundingClientRect().right > innerWidth + 1);
    const stage = document.querySelector('.stage').getBoundingClientRect();
    return [...wide.map((element) => `${element.className} reaches beyond the window`), ...(stage.width < 300 || stage.height < 200 ? [`the picture has ${stage.width} x ${stage.height}`] : [])];
  });
  check(faults.length === 0, `${width} px wide: ${faults.join('; ')}`);
}
