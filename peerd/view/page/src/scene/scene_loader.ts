import { loadSceneFile, type SceneFile } from './scene_file';

// Fetches the scene, one fetch at a time: what is edited while one is on its way is fetched after it, once.
export class SceneLoader {
  private loading: Promise<void> | null = null;
  private again = false;

  constructor(
    private readonly address: string,
    private readonly onScene: (file: SceneFile) => void,
    private readonly onFault: (sentence: string) => void,
  ) {}

  load(): Promise<void> {
    if (this.loading !== null) {
      this.again = true;
      return this.loading;
    }
    this.loading = this.fetchAll().finally(() => (this.loading = null));
    return this.loading;
  }

  private async fetchAll(): Promise<void> {
    do {
      this.again = false;
      await this.fetchOnce();
    } while (this.again);
  }

  private async fetchOnce(): Promise<void> {
    try {
      this.onScene(await loadSceneFile(this.address));
    } catch (fault) {
      this.onFault(`the scene cannot be shown: ${fault instanceof Error ? fault.message : String(fault)}`);
    }
  }
}
